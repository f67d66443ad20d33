// SPDX-License-Identifier: Apache-2.0
// What determines the colours of ray casters in addition to their samples.
#include "spu/volume/program/ray_caster.h"

#include <gmock/gmock.h>

#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Found {
  StageFacts facts;
  RayFinding finding;
};

/// A ray caster from a to b that executes `in_loop` with sample v and position p, and `after` behind the loop.
Found caster(const std::string& in_loop, const std::string& after = "", const std::string& before = "") {
  const std::vector<std::string> volumes{"volume"};
  Found found;
  found.facts =
      facts_of(shader("vec3 p = a.xyz; vec3 step = (b.xyz - a.xyz) * u.x; vec4 sum = vec4(0);"
                      "for (int i = 0; i < k; ++i) {"
                      "  if (any(greaterThan(p, vec3(1)))) break;"
                      "  vec4 v = texture(table, texture(volume, p).r);" +
                          in_loop +
                          "  sum += (1.0 - sum.a) * v;"
                          "  if (sum.a > 0.99) break;"
                          "  p += step;"
                          "}" +
                          after + "colour = sum;",
                      before));
  found.finding = ray_finding(found.facts, volumes);
  return found;
}

Texts words(const StageFacts& facts, const std::vector<Influence>& influences) {
  const std::vector<std::string> list = texts(facts, influences);
  return {list.begin(), list.end()};
}

TEST(RayCasters, ShowSamplesAndEndByPosition) {
  const auto [facts, finding] = caster("");
  EXPECT_TRUE(finding.of_one_texel_each());
  EXPECT_THAT(finding.reasons, IsEmpty());
  EXPECT_THAT(finding.discards, IsEmpty());
  EXPECT_THAT(finding.guards, IsEmpty());
  EXPECT_THAT(words(facts, finding.coordinates),
              ElementsAre("the volume's coordinate depends on the number of a loop's iteration",
                          "the volume's coordinate depends on varying a.xyz",
                          "the volume's coordinate depends on varying b.xyz"));
  EXPECT_THAT(words(facts, finding.loop_ends), Contains("colours depend on texel of 'table'.w"));
  EXPECT_THAT(finding.tables, ElementsAre("table"));
}

TEST(RayCasters, NameWhatIsNotTheSample) {
  EXPECT_THAT(caster("v.rgb *= p.z;").finding.reasons,
              ElementsAre("colours depend on varying a.z", "colours depend on varying b.z"));
  EXPECT_THAT(caster("if (p.y > list[0]) v = vec4(0);").finding.reasons,
              ElementsAre("varying a.y decides between colours", "varying b.y decides between colours"));
  EXPECT_THAT(caster("", "sum.r *= gl_FragCoord.x;").finding.reasons,
              ElementsAre("colours depend on gl_FragCoord.x"));
  EXPECT_THAT(caster("", "sum *= texture(volume, a.xyz);").finding.reasons,
              ElementsAre("colours depend on a texel of 'volume' that is fetched outside the loop"));
}

TEST(RayCasters, CountTheTexelsOfASample) {
  const Found lit = caster(
      "vec3 g = vec3(at(p, vec3(.01, 0, 0)), at(p, vec3(0, .01, 0)), at(p, vec3(0, 0, .01)));"
      "if (length(g) > list[1]) v.rgb *= dot(normalize(g), u.yzw);",
      "", "float at(vec3 p, vec3 by) { return texture(volume, p + by).r - texture(volume, p - by).r; }");
  EXPECT_EQ(lit.finding.samples.size(), 7U);
  EXPECT_FALSE(lit.finding.of_one_texel_each());
  EXPECT_THAT(words(lit.facts, lit.finding.guards), ElementsAre("texel of 'volume'.x decides between colours"));
}

TEST(RayCasters, TellNeighboursByWhatTheirPlacesDependOn) {
  const std::string at =
      "float at(vec3 p, vec3 by) { return texture(volume, p + by).r - texture(volume, p - by).r; }";
  const auto distance = [](const Found& found) {
    return neighbour_distance(found.facts, found.finding.samples);
  };
  const Found constant = caster("v.rgb *= at(p, vec3(u.y, 0, 0));", "", at);
  EXPECT_EQ(distance(constant), NeighbourDistance::in_texture_space);
  EXPECT_TRUE(address_tables_alone(constant.facts, constant.finding.samples));
  const Found by_place = caster("v.rgb *= at(p, vec3(a.w, 0, 0));", "", at);
  EXPECT_EQ(distance(by_place), std::nullopt);
  const Found by_value = caster("v.rgb *= at(p, vec3(v.r, 0, 0));", "", at);
  EXPECT_EQ(distance(by_value), std::nullopt);
  const Found by_slope = caster("v.a *= texture(table, at(p, vec3(u.y, 0, 0))).a;", "", at);
  EXPECT_EQ(distance(by_slope), NeighbourDistance::in_texture_space);
  EXPECT_FALSE(address_tables_alone(by_slope.facts, by_slope.finding.samples));
}

TEST(RayCasters, TellTablesOfGradientsFromTablesOfSamples) {
  const std::string functions =
      "uniform sampler2D slopes;"
      "float at(vec3 p, vec3 by) { return texture(volume, p + by).r - texture(volume, p - by).r; }"
      "float steepness(vec3 p) {"
      " return length(vec3(at(p, vec3(.1, 0, 0)), at(p, vec3(0, .1, 0)), at(p, vec3(0, 0, .1)))); }";
  const Found faded =
      caster("v.a *= texture(slopes, vec2(clamp(steepness(p) * u.y, 0.0, 1.0), 0.0)).r;", "", functions);
  EXPECT_THAT(faded.finding.tables_of_one_texel, ElementsAre("table"));
  EXPECT_THAT(faded.finding.tables_of_gradients, ElementsAre("slopes"));
  EXPECT_FALSE(address_tables_alone(faded.facts, faded.finding.samples));
  EXPECT_TRUE(address_tables_alone(faded.facts, faded.finding.samples, faded.finding.tables_of_gradients));
  const Found of_both =
      caster("v.a *= texture(slopes, vec2(steepness(p), texture(volume, p).r)).r;", "", functions);
  EXPECT_THAT(of_both.finding.tables_of_gradients, IsEmpty());
  const Found of_place = caster("v.a *= texture(slopes, vec2(steepness(p), p.x)).r;", "", functions);
  EXPECT_THAT(of_place.finding.tables_of_gradients, IsEmpty());
}

TEST(RayCasters, TellNeighboursThatAreCountedInTexels) {
  const auto distance = [](const std::string& in_loop, const std::string& before = "") {
    const Found found = caster(in_loop, "", before);
    return neighbour_distance(found.facts, found.finding.samples);
  };
  const std::string by_size =
      "float at(vec3 p) { vec3 d = vec3(1.0 / textureSize(volume, 0).x, 0, 0);"
      " return texture(volume, p + d).r - texture(volume, p - d).r; }";
  EXPECT_EQ(distance("v.rgb *= at(p);", by_size), NeighbourDistance::in_texels);
  EXPECT_EQ(distance("v.rgb *= texture(volume, p + vec3(1.0 / float(textureSize(table, 0)))).r;"),
            std::nullopt);
  EXPECT_EQ(distance("v.rgb *= textureOffset(volume, p, ivec3(1, 0, 0)).r"
                     " - textureOffset(volume, p, ivec3(-1, 0, 0)).r;"),
            NeighbourDistance::in_texels);
  EXPECT_EQ(distance("v.rgb *= textureLod(volume, p + vec3(u.y), 0.0).r;"),
            NeighbourDistance::in_texture_space);
  EXPECT_EQ(distance("v.rgb *= textureLod(volume, p + vec3(u.y), v.a).r;"), std::nullopt);
  // The gradient's reach would depend on the texture.
  EXPECT_EQ(distance("v.rgb *= textureOffset(volume, p, ivec3(1, 0, 0)).r - texture(volume, p + vec3(u.y)).r;"),
            std::nullopt);
}

TEST(RayCasters, FindNeighboursInLoopsOverTheAxes) {
  const auto distance = [](const std::string& end_of_loop, const std::string& moved) {
    const Found found = caster("vec3 g = vec3(0); for (int axis = 0; axis < " + end_of_loop +
                               "; ++axis) { vec3 by = vec3(0); by[axis] = " + moved +
                               "; g[axis] = texture(volume, p + by).r - texture(volume, p - by).r; }"
                               "v.rgb *= length(g);");
    return neighbour_distance(found.facts, found.finding.samples);
  };
  EXPECT_EQ(distance("3", "u.y"), NeighbourDistance::in_texture_space);
  EXPECT_EQ(distance("int(v.r * 3.0)", "u.y"), std::nullopt);
  EXPECT_EQ(distance("3", "v.r"), std::nullopt);
}

TEST(RayCasters, NameTexelsThatDecide) {
  const Found guarded = caster("if (v.a < list[2]) { p += step; continue; }");
  EXPECT_TRUE(guarded.finding.of_one_texel_each());
  EXPECT_THAT(words(guarded.facts, guarded.finding.guards),
              Contains("texel of 'table'.w decides between colours"));
  const Found first = caster("if (v.r > 0.5) { sum = v; break; }");
  EXPECT_TRUE(first.finding.of_one_texel_each());
  EXPECT_THAT(words(first.facts, first.finding.loop_ends), Contains("colours depend on texel of 'table'.xw"));
}

TEST(RayCasters, NameWhatDiscards) {
  const Found clipped = caster("", "if (a.x > list[3]) discard;");
  EXPECT_THAT(words(clipped.facts, clipped.finding.discards),
              ElementsAre("varying a.x decides which fragments are discarded"));
}

TEST(RayCasters, SayWhatUniformsReach) {
  const auto [facts, finding] = caster("v.r *= list[0];", "if (list[1] > 0.0) sum.g = list[2];");
  std::map<std::string, UniformUse> uses;
  for (const UniformUse& use : finding.uniforms) uses[text(facts.sources[use.source])] = use;
  EXPECT_TRUE(uses.at("uniform k").loop_end);
  EXPECT_FALSE(uses.at("uniform k").branch);
  EXPECT_TRUE(uses.at("uniform u.x").coordinate);
  EXPECT_TRUE(uses.at("uniform list[0]").colour);
  EXPECT_FALSE(uses.at("uniform list[0]").coordinate);
  EXPECT_TRUE(uses.at("uniform list[1]").branch);
  EXPECT_FALSE(uses.at("uniform list[2]").branch);
  EXPECT_FALSE(uses.contains("uniform list[3]"));
}

TEST(RayCasters, WithGlobalVariablesAndFunctionsAreFollowed) {
  const std::vector<std::string> volumes{"volume"};
  const StageFacts facts = facts_of(shader(
      "begin(); march(); colour = g_sum;",
      "vec3 g_p, g_step; vec4 g_sum; bool g_exit, g_skip;\n"
      "void begin() { g_sum = vec4(0); g_exit = false; g_p = a.xyz; g_step = normalize(b.xyz - a.xyz) * u.x;"
      "  if (gl_FragCoord.z >= texture(table, gl_FragCoord.x).r) discard; }\n"
      "float opacity(float v) { return texture(table, v).r; }\n"
      "vec4 march() { while (!g_exit) { g_skip = false;"
      "  if (!g_skip) { float v = texture(volume, g_p).r * list[0] + list[1]; vec4 c = vec4(0);"
      "    c.a = opacity(v); if (c.a > 0.0) { c.rgb = vec3(v) * c.a; g_sum = (1.0 - g_sum.a) * c + g_sum; } }"
      "  g_p += g_step; if (any(greaterThan(g_p, vec3(1)))) break; if (g_sum.a > list[2]) break; }"
      "  return g_sum; }\n"));
  const RayFinding finding = ray_finding(facts, volumes);
  EXPECT_TRUE(finding.of_one_texel_each()) << ::testing::PrintToString(finding.reasons);
  EXPECT_THAT(words(facts, finding.discards),
              Contains("gl_FragCoord.xz decides which fragments are discarded"));
  EXPECT_TRUE(finding.discards_by_place);
}

TEST(RayCasters, TellTablesOfSamplesFromMasks) {
  EXPECT_THAT(caster("").finding.tables_of_samples, ElementsAre("table"));
  EXPECT_THAT(caster("v *= texture(table, v.a);").finding.tables_of_samples, ElementsAre("table"));
  const std::string mask = "uniform sampler2D mask;\n";
  EXPECT_THAT(caster("if (texture(mask, p.xy).r < 0.5) v = vec4(0);", "", mask).finding.tables_of_samples,
              ElementsAre("table"));
  EXPECT_THAT(
      caster("if (texture(mask, gl_FragCoord.xy).r < 0.5) discard;", "", mask).finding.tables_of_samples,
      ElementsAre("table"));
  EXPECT_THAT(caster("v *= texture(mask, vec2(v.a, float(i)));", "", mask).finding.tables_of_samples,
              ElementsAre("table"));
  EXPECT_THAT(caster("v *= texture(table, p.x);").finding.tables_of_samples, IsEmpty());
  EXPECT_THAT(caster("v *= texture(mask, v.ra * u.xy);", "", mask).finding.tables_of_samples,
              ElementsAre("mask", "table"));
}

TEST(RayCasters, WithoutALoopAreNone) {
  const std::vector<std::string> volumes{"volume"};
  const RayFinding finding = ray_finding(facts_of(shader("colour = texture(volume, a.xyz);")), volumes);
  EXPECT_FALSE(finding.of_one_texel_each());
  EXPECT_THAT(finding.reasons, Contains("no loop fetches the volume"));
}

}  // namespace
}  // namespace understudy::spu::program::testing
