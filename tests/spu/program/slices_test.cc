// SPDX-License-Identifier: Apache-2.0
// Whether slices show a function of the sample, and what is reported if they do not.
#include "spu/volume/program/slices.h"

#include <gmock/gmock.h>

#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

SliceFinding finding_of(const std::string& body, const std::string& before = "",
                        const std::vector<KnownUniform>& known = {}) {
  const std::vector<std::string> volumes{"volume"};
  return slice_finding(facts_of(shader(body, before), Stage::fragment, known), volumes);
}

TEST(Slices, ShowFunctionsOfTheSample) {
  for (const char* body : {
           "colour = texture(volume, a.xyz);",
           "colour = texture(table, texture(volume, a.xyz).r * u.x + u.y);",
           "float v = texture(volume, a.xyz).r; colour = v > u.x ? vec4(v) : vec4(0, 0, 1, v);",
           "float v = texture(volume, a.xyz).r; if (v < u.x) discard; colour = vec4(v, list[int(v * 4.0)], 0, "
           "1);",
           "vec4 v = texture(volume, a.xyz); for (int i = 0; i < 3; ++i) v[i] = pow(v[i], u.x); colour = v;",
           "colour = vec4(texture(volume, a.xyz).r, texture(volume, a.xyz).g, 0.0, 1.0);",
           "vec4 v = vec4(0); for (int i = 0; i < 3; ++i) v += texture(volume, a.xyz); colour = v;",
           "float v = texture(volume, a.xyz).r; colour = vec4(0); for (int i = 0; i < 4; ++i)"
           " if (v > list[i]) colour = vec4(i); colour.a = v;",
           "float v = texture(volume, a.xyz).r; if (b.x > 0.0) colour = vec4(v); else colour = vec4(v);",
       }) {
    const SliceFinding finding = finding_of(body);
    EXPECT_TRUE(finding.of_one_texel()) << body;
    EXPECT_TRUE(finding.coordinate_is_varying) << body;
    EXPECT_THAT(finding.reasons, IsEmpty()) << body;
  }
}

TEST(Slices, NameWhatElseReachesColours) {
  const auto reasons = [](const std::string& body) {
    return finding_of("vec4 v = texture(volume, a.xyz); colour = v; " + body).reasons;
  };
  EXPECT_THAT(reasons("if (a.z > u.z) discard;"),
              ElementsAre("varying a.z decides which fragments are discarded"));
  EXPECT_THAT(reasons("colour.rgb *= a.z;"), ElementsAre("colours depend on varying a.z"));
  EXPECT_THAT(reasons("colour *= b;"), ElementsAre("colours depend on varying b.xyzw"));
  EXPECT_THAT(reasons("if (gl_FragCoord.x > 100.0) colour.r = 0.0;"),
              ElementsAre("gl_FragCoord.x decides between colours"));
  EXPECT_THAT(reasons("colour += texture(volume, a.xyz + vec3(0, 0, 0.01));"),
              ElementsAre("colours depend on a second texel of 'volume' at an offset"));
  EXPECT_THAT(reasons("colour += textureOffset(volume, a.xyz, ivec3(1, 0, 0));"),
              ElementsAre("colours depend on a second texel of 'volume' at an offset"));
  EXPECT_THAT(reasons("colour += texture(volume, b.xyz);"),
              ElementsAre("colours depend on a second texel of 'volume' at varying b"));
  EXPECT_THAT(
      reasons("for (int i = 0; i < 4; ++i) colour += texture(volume, a.xyz + vec3(0, 0, 0.01 * float(i)));"),
      Contains("colours depend on several texels, fetched in a loop"));
  EXPECT_THAT(reasons("colour *= texture(table, a.y).r;"), ElementsAre("colours depend on varying a.y"));
  EXPECT_THAT(reasons("if (texture(table, b.y).r > 0.5) discard;"),
              ElementsAre("varying b.y decides which fragments are discarded"));
  EXPECT_THAT(reasons("colour.r += dFdx(v.r);"), ElementsAre("colours depend on neighbouring pixels"));
  EXPECT_THAT(reasons("if (!gl_FrontFacing) colour.r = 0.0;"),
              ElementsAre("gl_FrontFacing decides between colours"));
  EXPECT_THAT(reasons("gl_FragDepth = a.z;"), ElementsAre("depth depends on varying a.z"));
  EXPECT_THAT(reasons("int i = 0; while (float(i) < 9.0 * a.y) ++i; colour.r = float(i);"),
              ElementsAre("colours depend on varying a.y"));
}

TEST(Slices, NameWhatElseReachesTheCoordinate) {
  const SliceFinding bent = finding_of("colour = texture(volume, a.xyz + texture(table, gl_FragCoord.x).xyz);");
  EXPECT_FALSE(bent.of_one_texel());
  EXPECT_THAT(bent.reasons, Contains("the volume's coordinate depends on gl_FragCoord.x"));
  const SliceFinding scaled = finding_of("colour = texture(volume, a.xyz * u.xyz);");
  EXPECT_TRUE(scaled.of_one_texel());
  EXPECT_FALSE(scaled.coordinate_is_varying);
}

TEST(Slices, WithoutTheVolumeAreNone) {
  EXPECT_THAT(finding_of("colour = a;").reasons, Contains("colours do not depend on the volume"));
}

TEST(Slices, SayWhatUniformsReach) {
  const StageFacts facts =
      facts_of(shader("float v = texture(volume, a.xyz + u.xyz).r; if (v < list[0]) discard;"
                      "colour = v > list[1] ? vec4(list[2]) : texture(table, v + list[3]);"));
  const std::vector<std::string> volumes{"volume"};
  const SliceFinding finding = slice_finding(facts, volumes);
  EXPECT_THAT(finding.tables, ElementsAre("table"));
  for (const UniformUse& use : finding.uniforms) {
    const Source& source = facts.sources[use.source];
    EXPECT_EQ(use.coordinate, source.name == "u") << text(source);
    EXPECT_EQ(use.discard, source.name == "list[0]") << text(source);
    EXPECT_EQ(use.colour, source.name == "list[1]" || source.name == "list[2]" || source.name == "list[3]");
    EXPECT_EQ(use.branch, source.name == "list[0]" || source.name == "list[1]") << text(source);
  }
  EXPECT_EQ(finding.uniforms.size(), 7U);
}

TEST(Slices, UnderKnownUniformsAreWhatTheyShow) {
  const std::string body =
      "if (k != 0 && texture(mask, a.xyz).r > 0.5) discard; colour = texture(volume, a.xyz);";
  EXPECT_FALSE(finding_of(body, "uniform sampler3D mask;").of_one_texel());
  EXPECT_TRUE(finding_of(body, "uniform sampler3D mask;", {{"k", 0, 0}}).of_one_texel());
}

TEST(Slices, WithSideEffectsAreNone) {
  const std::vector<std::string> volumes{"volume"};
  const SliceFinding finding = slice_finding(
      facts_of("#version 430\nuniform sampler3D volume; layout(r32f) uniform image2D seen; in vec3 a; out vec4 "
               "colour;\n"
               "void main() { colour = texture(volume, a); imageStore(seen, ivec2(0), colour); }\n"),
      volumes);
  EXPECT_FALSE(finding.of_one_texel());
  EXPECT_THAT(finding.reasons, Contains("it writes to 'seen'"));
}

}  // namespace
}  // namespace understudy::spu::program::testing
