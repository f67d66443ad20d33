// SPDX-License-Identifier: Apache-2.0
// Analysis of assembly programs.
#include <gmock/gmock.h>

#include "spu/volume/program/slices.h"
#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

StageFacts assembly(const std::string& body) {
  const StageFinding finding = analyse_assembly("!!ARBfp1.0\n" + body + "\nEND\n");
  if (const auto* failure = std::get_if<Failure>(&finding)) ADD_FAILURE() << failure->what;
  return std::holds_alternative<StageFacts>(finding) ? std::get<StageFacts>(finding) : StageFacts{};
}

TEST(AssemblyPrograms, ClassifySamples) {
  const StageFacts facts = assembly(
      "# a slicer\n"
      "ATTRIB place = fragment.texcoord[0];\n"
      "PARAM window = program.local[0];\n"
      "TEMP v, c;\n"
      "TEX v, place, texture[0], 3D;\n"
      "MAD_SAT v.x, v.x, window.x, window.y;\n"
      "TEX c, v.x, texture[1], 1D;\n"
      "MUL result.color.rgb, c, c.a;\n"
      "MOV result.color.a, c;\n");
  EXPECT_THAT(reaches(facts, "result.color", 0),
              ElementsAre("texel of 'texture[1]'.w", "texel of 'texture[1]'.x"));
  EXPECT_THAT(reaches(facts, "result.color", 3), ElementsAre("texel of 'texture[1]'.w"));
  ASSERT_EQ(facts.fetches.size(), 2U);
  EXPECT_EQ(text(facts.fetches[0].type), "sampler3D");
  EXPECT_EQ(facts.fetches[1].line, 8);
  const std::vector<std::string> volumes{"texture[0]"};
  const SliceFinding finding = slice_finding(facts, volumes);
  EXPECT_TRUE(finding.of_one_texel());
  EXPECT_TRUE(finding.coordinate_is_varying);
  EXPECT_EQ(finding.uniforms.size(), 2U);
}

TEST(AssemblyPrograms, NameWhatElseReachesColours) {
  const std::vector<std::string> volumes{"texture[0]"};
  const auto reasons = [&](const std::string& more) {
    return slice_finding(assembly("TEMP v, w; PARAM k[3] = { program.env[4..5], { 1, 0.5 } };\n"
                                  "TEX v, fragment.texcoord[0], texture[0], 3D;\n" +
                                  more + "MOV result.color, v;\n"),
                         volumes)
        .reasons;
  };
  EXPECT_THAT(reasons(""), IsEmpty());
  EXPECT_THAT(reasons("SUB w.x, fragment.texcoord[0].z, k[1].x; KIL w.x;\n"),
              ElementsAre("varying fragment.texcoord[0].z decides which fragments are discarded"));
  EXPECT_THAT(reasons("MUL v, v, fragment.color.primary;\n"),
              ElementsAre("colours depend on varying fragment.color.primary.xyzw"));
  EXPECT_THAT(reasons("ADD w, fragment.texcoord[0], k[2]; TEX w, w, texture[0], 3D; ADD v, v, w;\n"),
              ElementsAre("colours depend on a second texel of 'texture[0]' at an offset"));
  EXPECT_THAT(reasons("DP3 v.x, v, fragment.position;\n"),
              ElementsAre("colours depend on fragment.position.xyz"));
  EXPECT_THAT(reasons("OPTION ARB_fog_linear;\n"),
              ElementsAre("colours depend on varying fragment.fogcoord.x"));
  EXPECT_THAT(reasons("SWZ v, v, 1, 0, -y, x;\n"), IsEmpty());
  EXPECT_THAT(reasons("LRP v, v.w, v, state.light[0].ambient;\n"), IsEmpty());
}

TEST(AssemblyPrograms, ClampedValuesAreNoCopies) {
  const std::vector<std::string> volumes{"texture[0]"};
  const auto coordinate_is_varying = [&](const std::string& copy) {
    return slice_finding(assembly("TEMP p; " + copy + " p, fragment.texcoord[0];\n" +
                                  "TEX result.color, p, texture[0], 3D;\n"),
                         volumes)
        .coordinate_is_varying;
  };
  EXPECT_TRUE(coordinate_is_varying("MOV"));
  EXPECT_FALSE(coordinate_is_varying("MOV_SAT"));
  const StageFacts both = assembly(
      "TEMP a, b; ADD a, fragment.texcoord[0], 0.5; ADD_SAT b, fragment.texcoord[0], 0.5;\n"
      "TEX a, a, texture[0], 3D; TEX b, b, texture[0], 3D; ADD result.color, a, b;\n");
  ASSERT_EQ(both.fetches.size(), 2U);
  EXPECT_NE(both.fetches[0].place, both.fetches[1].place);
}

TEST(AssemblyPrograms, ElementsBehindAMatrixKeepTheirPlaces) {
  const StageFacts facts = assembly(
      "PARAM k[6] = { program.local[0], state.matrix.mvp, program.local[7] };\n"
      "MOV result.color, k[5];\n");
  EXPECT_THAT(reaches(facts, "result.color", 0), ElementsAre("uniform program.local[7].x"));
}

TEST(AssemblyPrograms, BiasedShadowLookupsKeepTheirReference) {
  const StageFacts facts = assembly(
      "OPTION ARB_fragment_program_shadow; TEMP p; MOV p, fragment.texcoord[0]; MOV p.z, "
      "fragment.texcoord[1].x;\n"
      "MOV p.w, fragment.texcoord[2].y; TXB result.color, p, texture[0], SHADOW2D;\n");
  ASSERT_EQ(facts.fetches.size(), 1U);
  EXPECT_EQ(facts.fetches[0].modifiers.size(), 2U);
}

TEST(AssemblyPrograms, BeginInTheLineOfTheHeader) {
  const StageFinding finding = analyse_assembly(
      "!!ARBfp1.0 TEMP v; TEX v, fragment.texcoord, texture, 3D; KIL fragment.color.x;\n"
      "# a comment that ends here\rMUL result.color, v, fragment.fogcoord.x;\nEND\n");
  ASSERT_TRUE(std::holds_alternative<StageFacts>(finding)) << std::get<Failure>(finding).what;
  const StageFacts& facts = std::get<StageFacts>(finding);
  ASSERT_EQ(facts.fetches.size(), 1U);
  EXPECT_EQ(facts.fetches[0].sampler, "texture[0]");
  const std::vector<std::string> volumes{"texture[0]"};
  const SliceFinding slices = slice_finding(facts, volumes);
  EXPECT_THAT(slices.reasons,
              ElementsAre("varying fragment.color.primary.x decides which fragments are discarded",
                          "colours depend on varying fragment.fogcoord.x"));
  EXPECT_THAT(texts(facts, slices.coordinate_varyings),
              ElementsAre("the volume's coordinate depends on varying fragment.texcoord[0].xyz"));
}

TEST(AssemblyPrograms, ConstantsHaveSignsAndComponents) {
  const StageFacts facts = assembly(
      "PARAM k[2] = { -0.5, { 1, 2, 3, 4 } }; TEMP a, b;\n"
      "ADD a, fragment.texcoord[0], {0, 0, 0.1, 0}; ADD b, fragment.texcoord[0], {0, 0, 0.1, 0}.z;\n"
      "TEX a, a, texture[0], 3D; TEX b, b, texture[0], 3D; MUL a, a, k[0]; ADD result.color, a, b;\n");
  ASSERT_EQ(facts.fetches.size(), 2U);
  EXPECT_NE(facts.fetches[0].place, facts.fetches[1].place);
  EXPECT_THAT(reaches(facts, "result.color", 0), ElementsAre("texel of 'texture[0]'.x"));
}

TEST(AssemblyPrograms, OfVerticesAreRead) {
  const StageFinding finding = analyse_assembly(
      "!!ARBvp1.0\nPARAM m[4] = { state.matrix.mvp }; ADDRESS A0;\nDP4 result.position.x, m[0], "
      "vertex.position;\n"
      "MOV result.texcoord[0], vertex.texcoord[0];\nARL A0.x, vertex.attrib[5].x;\nMOV result.color, m[A0.x + "
      "1];\nEND\n");
  ASSERT_TRUE(std::holds_alternative<StageFacts>(finding)) << std::get<Failure>(finding).what;
  const StageFacts& facts = std::get<StageFacts>(finding);
  EXPECT_THAT(reaches(facts, "result.texcoord[0]", 1), ElementsAre("attribute vertex.texcoord[0].y"));
  EXPECT_THAT(reaches(facts, "result.position", 0), Contains("attribute vertex.position.w"));
}

TEST(AssemblyPrograms, ThatAreNotFollowedFail) {
  const auto what = [](const std::string& text) { return std::get<Failure>(analyse_assembly(text)).what; };
  EXPECT_THAT(what("!!ARBfp1.0\nOPTION NV_fragment_program2;\nEND"), HasSubstr("OPTION NV_fragment_program2"));
  EXPECT_THAT(what("!!ARBfp1.0\nDDX result.color, fragment.position;\nEND"), HasSubstr("instruction DDX"));
  EXPECT_THAT(what("!!NVfp4.0\nEND"), HasSubstr("neither"));
  EXPECT_THAT(what("!!ARBfp1.0\nSWZ result.color, fragment.color, 0, 1, ,;\nEND"), HasSubstr("empty operand"));
  EXPECT_THAT(what("!!ARBfp1.0\nTEX;\nEND"), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace understudy::spu::program::testing
