// SPDX-License-Identifier: Apache-2.0
// What values depend on: component by component, through variables, functions, branches and loops.
#include <gmock/gmock.h>

#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(ValuesInShaders, AreFollowedComponentByComponent) {
  const StageFacts facts = facts_of(shader("colour = vec4(a.zy, u.x, 1.0);"));
  EXPECT_THAT(reaches(facts, "colour", 0), ElementsAre("varying a.z"));
  EXPECT_THAT(reaches(facts, "colour", 1), ElementsAre("varying a.y"));
  EXPECT_THAT(reaches(facts, "colour", 2), ElementsAre("uniform u.x"));
  EXPECT_THAT(reaches(facts, "colour", 3), IsEmpty());
}

TEST(ValuesInShaders, AreWrittenThroughSwizzles) {
  const StageFacts facts = facts_of(shader("colour = a; colour.zx = u.yw; colour.y *= b.x;"));
  EXPECT_THAT(reaches(facts, "colour", 0), ElementsAre("uniform u.w"));
  EXPECT_THAT(reaches(facts, "colour", 1), ElementsAre("varying a.y", "varying b.x"));
  EXPECT_THAT(reaches(facts, "colour", 2), ElementsAre("uniform u.y"));
  EXPECT_THAT(reaches(facts, "colour", 3), ElementsAre("varying a.w"));
}

TEST(ValuesInShaders, AreFollowedThroughStructures) {
  const std::string before = "struct Light { vec3 place; float gain[2]; }; uniform Light light[3];";
  EXPECT_THAT(
      colour_of("Light l = light[1]; l.gain[0] = a.x; colour = vec4(l.gain[1] + l.place.y);", 0, before),
      ElementsAre("uniform light[1].gain[1]", "uniform light[1].place.y"));
  EXPECT_THAT(colour_of("Light l = light[1]; l.gain[0] = a.x; colour = vec4(l.gain[0]);", 0, before),
              ElementsAre("varying a.x"));
}

TEST(ValuesInShaders, DependOnWhatAnIndexCanChoose) {
  EXPECT_THAT(colour_of("colour = vec4(list[2]);"), ElementsAre("uniform list[2]"));
  EXPECT_THAT(
      colour_of("colour = vec4(list[k & 3]);"),
      ElementsAre("uniform k", "uniform list[0]", "uniform list[1]", "uniform list[2]", "uniform list[3]"));
  EXPECT_THAT(colour_of("float f[2] = float[2](a.x, a.y); f[k & 1] = b.z; colour = vec4(f[1]);"),
              ElementsAre("uniform k", "varying a.y", "varying b.z"));
  EXPECT_THAT(colour_of("colour = vec4(a[k & 3]);"),
              ElementsAre("uniform k", "varying a.w", "varying a.x", "varying a.y", "varying a.z"));
  EXPECT_THAT(colour_of("int i = 1; i += 1; colour = vec4(list[i]);"), ElementsAre("uniform list[2]"));
}

TEST(ValuesInShaders, DependOnRowsAndColumnsOfMatrices) {
  EXPECT_THAT(colour_of("colour = vec4((m * a.xy).y);", 0, "uniform mat2 m;"),
              ElementsAre("uniform m[0][1]", "uniform m[1][1]", "varying a.x", "varying a.y"));
  EXPECT_THAT(colour_of("colour = vec4((a.xy * m).y);", 0, "uniform mat2 m;"),
              ElementsAre("uniform m[1][0]", "uniform m[1][1]", "varying a.x", "varying a.y"));
  EXPECT_THAT(colour_of("colour = vec4(transpose(m)[0][1]);", 0, "uniform mat2 m;"),
              ElementsAre("uniform m[1][0]"));
  EXPECT_THAT(colour_of("colour = vec4((m * n)[1][0]);", 0, "uniform mat3x2 m; uniform mat2x3 n;"),
              ElementsAre("uniform m[0][0]", "uniform m[1][0]", "uniform m[2][0]", "uniform n[1][0]",
                          "uniform n[1][1]", "uniform n[1][2]"));
  EXPECT_THAT(colour_of("mat3 l = mat3(m); colour = vec4(l[1][1], l[2][0], l[2][2], 0);", 0, "uniform mat2 m;"),
              ElementsAre("uniform m[1][1]"));
}

TEST(ValuesInShaders, AreMixedByFunctionsOfVectors) {
  EXPECT_THAT(colour_of("colour = vec4(dot(a.xy, u.zw));"),
              ElementsAre("uniform u.w", "uniform u.z", "varying a.x", "varying a.y"));
  EXPECT_THAT(colour_of("colour.xyz = cross(a.xyz, vec3(1)); colour.w = 0.0;"),
              ElementsAre("varying a.y", "varying a.z"));
  EXPECT_THAT(colour_of("colour = mix(a, b, u.x);", 2),
              ElementsAre("uniform u.x", "varying a.z", "varying b.z"));
  EXPECT_THAT(colour_of("float whole; colour = vec4(modf(a.x, whole)); colour.y = whole;", 1),
              ElementsAre("varying a.x"));
}

TEST(ValuesInShaders, AreFollowedIntoFunctions) {
  const std::string before =
      "float first(vec2 v) { return v.x; }\n"
      "void twist(inout vec2 v, out float rest, const in float by) { rest = v.x; v = vec2(v.y, by); }\n";
  EXPECT_THAT(colour_of("colour = vec4(first(a.yz) + first(b.xy));", 0, before),
              ElementsAre("varying a.y", "varying b.x"));
  EXPECT_THAT(colour_of("vec2 v = a.xy; float r; twist(v, r, u.x); colour = vec4(v, r, 0.0);", 0, before),
              ElementsAre("varying a.y"));
  EXPECT_THAT(colour_of("vec2 v = a.xy; float r; twist(v, r, u.x); colour = vec4(v, r, 0.0);", 1, before),
              ElementsAre("uniform u.x"));
  EXPECT_THAT(colour_of("vec2 v = a.xy; float r; twist(v, r, u.x); colour = vec4(v, r, 0.0);", 2, before),
              ElementsAre("varying a.x"));
}

TEST(ValuesInShaders, ReachGlobalVariablesFromFunctions) {
  const std::string before =
      "vec3 position = a.xyz; float gain = 1.0; void advance() { position += u.xyz; gain = list[1]; }";
  EXPECT_THAT(colour_of("advance(); colour = vec4(position.z, gain, 0.0, 1.0);", 0, before),
              ElementsAre("uniform u.z", "varying a.z"));
  EXPECT_THAT(colour_of("advance(); colour = vec4(position.z, gain, 0.0, 1.0);", 1, before),
              ElementsAre("uniform list[1]"));
}

TEST(Branches, DecideOnlyWhatTheyChange) {
  const StageFacts facts = facts_of(shader("colour = b; if (a.x > u.x) colour.y = 1.0;"));
  EXPECT_THAT(reaches(facts, "colour", 0), ElementsAre("varying b.x"));
  EXPECT_THAT(reaches(facts, "colour", 1),
              ElementsAre("uniform u.x (branch)", "varying a.x (branch)", "varying b.y"));
}

TEST(Branches, DoNotMatterWhereBothWaysBringTheSame) {
  EXPECT_THAT(colour_of("float f; if (a.x > 0.0) f = b.x; else f = b.x; colour = vec4(f);"),
              ElementsAre("varying b.x"));
  EXPECT_THAT(colour_of("float f = a.y > 0.0 ? b.x : b.x; colour = vec4(f);"), ElementsAre("varying b.x"));
}

TEST(Branches, AreCountedInChoicesAndShortCircuits) {
  EXPECT_THAT(colour_of("colour = vec4(a.x > 0.0 ? b.x : u.x);"),
              ElementsAre("uniform u.x", "varying a.x (branch)", "varying b.x"));
  EXPECT_THAT(colour_of("float f = 0.0; bool t = a.x > 0.0 && (f = b.x) > 0.0; colour = vec4(f);"),
              ElementsAre("varying a.x (branch)", "varying b.x"));
  EXPECT_THAT(colour_of("colour = vec4(a.x > 0.0 || b.x > 0.0);"), ElementsAre("varying a.x", "varying b.x"));
}

TEST(Branches, AreCountedAfterEarlyReturns) {
  EXPECT_THAT(colour_of("colour = vec4(0); if (a.x > 0.0) { if (a.y > 0.0) return; colour.x = 1.0; }"),
              ElementsAre("varying a.x (branch)", "varying a.y (branch)"));
  EXPECT_THAT(colour_of("colour = vec4(f());", 0, "float f() { if (a.x > 0.0) return b.x; return b.y; }"),
              ElementsAre("varying a.x (branch)", "varying b.x", "varying b.y"));
}

TEST(Branches, AreCountedInSwitches) {
  const std::string body =
      "colour = vec4(0); switch (k) { case 0: colour.x = a.x; break; case 1: colour.y = a.y; default: colour.z "
      "= a.z; }";
  EXPECT_THAT(colour_of(body, 0), ElementsAre("uniform k (branch)", "varying a.x"));
  EXPECT_THAT(colour_of(body, 1), ElementsAre("uniform k (branch)", "varying a.y"));
  EXPECT_THAT(colour_of(body, 2), ElementsAre("uniform k (branch)", "varying a.z"));
  EXPECT_THAT(colour_of(body, 3), IsEmpty());
}

TEST(Branches, OnConstantsAreTakenOneWay) {
  EXPECT_THAT(colour_of("colour = b; if (lit) colour = a;", 0, "const bool lit = false;"),
              ElementsAre("varying b.x"));
  EXPECT_THAT(colour_of("bool lit = false; colour = b; if (lit && a.x > 0.0) colour = a;"),
              ElementsAre("varying b.x"));
}

TEST(Branches, OnKnownUniformsAreTakenOneWay) {
  const std::string text = shader("colour = b; if (k == 1 || list[2] > 0.5) colour = a;");
  EXPECT_THAT(reaches(facts_of(text, Stage::fragment, {{"k", 0, 0}, {"list[2]", 0, 0.25}}), "colour"),
              ElementsAre("varying b.x"));
  EXPECT_THAT(reaches(facts_of(text, Stage::fragment, {{"k", 0, 1}}), "colour"), ElementsAre("varying a.x"));
}

TEST(Loops, LeaveWhatAnIterationDoesNotChange) {
  EXPECT_THAT(colour_of("colour = b; for (int i = 0; i < k; ++i) colour.y += a.x;"),
              ElementsAre("varying b.x"));
}

TEST(Loops, MakeResultsDependOnWhenTheyEnd) {
  EXPECT_THAT(colour_of("colour = vec4(0); for (int i = 0; i < k; ++i) colour.x += a.x;"),
              ElementsAre("the number of a loop's iteration", "the number of a loop's iteration (loop)",
                          "uniform k (loop)", "varying a.x"));
  EXPECT_THAT(colour_of("float f = 0.0; while (true) { if (a.y < f) break; f += a.x; } colour = vec4(f);"),
              Contains("varying a.y (loop)"));
  EXPECT_THAT(colour_of("float f = 0.0; do { f += a.x; } while (f < u.x); colour = vec4(f);"),
              Contains("uniform u.x (loop)"));
}

TEST(Loops, CarryValuesFromIterationToIteration) {
  const Texts last = colour_of(
      "float f = 0.0, g = 0.0, h = 0.0; for (int i = 0; i < 9; ++i) { h = g; g = f; f = a.x; } colour = "
      "vec4(h);");
  EXPECT_THAT(last, Contains("varying a.x"));
}

TEST(Loops, CountWhatIsPassedByContinue) {
  const Texts sum = colour_of(
      "float f = 0.0; for (int i = 0; i < 9; ++i) { if (a.y > f) continue; f += a.x; } colour = vec4(f);");
  EXPECT_THAT(sum, Contains("varying a.y (branch)"));
}

TEST(Loops, CountWhatAnotherWayOutPassesBy) {
  const Texts sum = colour_of(
      "float f = 0.0; for (int i = 0; i < 9; ++i) { if (a.y > f) continue; if (b.x > 1.0) break; ++f; }"
      "colour = vec4(f);");
  EXPECT_THAT(sum, Contains("varying b.x (loop)"));
  EXPECT_THAT(sum, Contains("varying a.y (loop)"));
}

TEST(Loops, AreLeftByReturn) {
  const std::string before =
      "float f() { float s = 0.0; for (int i = 0; i < 9; ++i) { s += a.x; if (s > b.y) return s; } return "
      "-1.0; }";
  const Texts found = colour_of("colour = vec4(f());", 0, before);
  EXPECT_THAT(found, Contains("varying a.x"));
  EXPECT_THAT(found, Contains("varying b.y (loop)"));
}

TEST(Loops, WithinLoopsEndByTheirOwnConditions) {
  const StageFacts facts =
      facts_of(shader("colour = vec4(0);"
                      "for (int i = 0; i < 3; ++i) { for (int j = 0; j < k; ++j) { if (a.x > 1.0) break; "
                      "colour.x += b.x; } }"));
  ASSERT_EQ(facts.loops.size(), 2U);
  EXPECT_THAT(texts_of(facts, facts.loops[0].condition), Not(Contains("varying a.x (loop)")));
  EXPECT_THAT(texts_of(facts, facts.loops[1].condition), Contains("varying a.x (loop)"));
  EXPECT_EQ(facts.loops[1].outer, 0U);
}

TEST(Discards, NameWhatDecides) {
  const StageFacts facts = facts_of(shader("colour = a; if (u.x > 0.0 && b.z > 0.5) discard; colour.x = 1.0;"));
  ASSERT_EQ(facts.discards.size(), 1U);
  EXPECT_THAT(texts_of(facts, facts.discards[0].on),
              ElementsAre("uniform u.x (branch)", "varying b.z (branch)"));
  EXPECT_THAT(reaches(facts, "colour", 1), ElementsAre("varying a.y"));
}

TEST(Discards, InFunctionsNameWhatDecidesTheCall) {
  const StageFacts facts =
      facts_of(shader("colour = a; if (a.x > 0.0) cut(b.y);", "void cut(float f) { if (f > u.z) discard; }"));
  ASSERT_EQ(facts.discards.size(), 1U);
  EXPECT_THAT(texts_of(facts, facts.discards[0].on),
              ElementsAre("uniform u.z (branch)", "varying a.x (branch)", "varying b.y (branch)"));
}

TEST(Discards, AfterAnEarlyReturnNameItsCondition) {
  const StageFacts facts = facts_of(shader("colour = a; if (a.w > 0.0) return; if (b.y > 0.0) discard;"));
  ASSERT_EQ(facts.discards.size(), 1U);
  EXPECT_THAT(texts_of(facts, facts.discards[0].on),
              ElementsAre("varying a.w (branch)", "varying b.y (branch)"));
}

TEST(Fetches, AreSourcesOfTheirOwn) {
  const StageFacts facts =
      facts_of(shader("float v = texture(volume, a.xyz).r; colour = texture(table, v * u.x);"));
  EXPECT_THAT(reaches(facts, "colour", 3), ElementsAre("texel of 'table'.w"));
  ASSERT_EQ(facts.fetches.size(), 2U);
  EXPECT_EQ(text(facts.fetches[0].type), "sampler3D");
  EXPECT_EQ(facts.sources[facts.fetches[0].exact.at(2).value()].component, 2);
  EXPECT_EQ(text(facts.fetches[1].type), "sampler1D");
  EXPECT_THAT(texts_of(facts, facts.fetches[1].coordinate.at(0)),
              ElementsAre("texel of 'volume'.x", "uniform u.x"));
  EXPECT_FALSE(facts.fetches[1].exact.at(0));
}

TEST(Fetches, OfOneTexelHaveOnePlace) {
  const StageFacts facts = facts_of(shader(
      "float s = 0.0; vec3 tc = a.xyz; s += texture(volume, tc).r + at(vec3(0.0)) + texture(volume, a.xyz).g;"
      "s += at(vec3(0.0, 0.0, 0.01)); tc.z += 0.5; s += texture(volume, tc).r; colour = vec4(s);",
      "float at(vec3 offset) { return texture(volume, a.xyz + offset).r; }"));
  ASSERT_EQ(facts.fetches.size(), 5U);
  EXPECT_EQ(facts.fetches[0].place, facts.fetches[1].place);
  EXPECT_EQ(facts.fetches[0].place, facts.fetches[2].place);
  EXPECT_NE(facts.fetches[0].place, facts.fetches[3].place);
  EXPECT_NE(facts.fetches[0].place, facts.fetches[4].place);
}

TEST(Fetches, SayWhetherAndHowOftenTheyAreExecuted) {
  const StageFacts facts =
      facts_of(shader("colour = vec4(0); for (int i = 0; i < k; ++i) if (b.x > 0.0) colour += texture(volume, "
                      "a.xyz * float(i));"));
  ASSERT_EQ(facts.fetches.size(), 1U);
  EXPECT_EQ(facts.fetches[0].loop, 0U);
  EXPECT_THAT(texts_of(facts, facts.fetches[0].execution), Contains("uniform k (loop)"));
  EXPECT_THAT(texts_of(facts, facts.fetches[0].execution), Contains("varying b.x (branch)"));
  EXPECT_THAT(texts_of(facts, facts.fetches[0].coordinate.at(1)),
              ElementsAre("the number of a loop's iteration", "varying a.y"));
}

TEST(Fetches, SayHowTheyAreMade) {
  const StageFacts facts = facts_of(
      shader("colour = textureLod(volume, a.xyz, u.x) + texelFetch(volume, ivec3(a.xyz), k)"
             " + textureOffset(volume, a.xyz, ivec3(1)) + textureProj(volume, a) + texture(volume, a.xyz, u.y)"
             " + textureGrad(volume, a.xyz, u.xyz, u.xyz);"));
  ASSERT_EQ(facts.fetches.size(), 6U);
  EXPECT_TRUE(facts.fetches[0].level);
  EXPECT_THAT(texts_of(facts, facts.fetches[0].modifiers), ElementsAre("uniform u.x"));
  EXPECT_EQ(facts.fetches[1].function, FetchFunction::exact);
  EXPECT_TRUE(facts.fetches[2].offset);
  EXPECT_TRUE(facts.fetches[3].projected);
  EXPECT_THAT(texts_of(facts, facts.fetches[3].coordinate.at(0)), ElementsAre("varying a.w", "varying a.x"));
  EXPECT_TRUE(facts.fetches[4].bias);
  EXPECT_TRUE(facts.fetches[5].gradient);
}

TEST(Fetches, BySamplersThatArePassedOrChosen) {
  const std::string before =
      "uniform sampler3D fields[2]; vec4 read(sampler3D s) { return texture(s, a.xyz); }";
  const StageFacts facts = facts_of(shader("colour = read(volume) + read(fields[1]);", before));
  ASSERT_EQ(facts.fetches.size(), 2U);
  EXPECT_EQ(facts.fetches[0].sampler, "volume");
  EXPECT_EQ(facts.fetches[1].sampler, "fields[1]");
  const StageFacts chosen = facts_of(
      "#version 400\nuniform sampler3D fields[2]; uniform int k; in vec3 a; out vec4 colour;\n"
      "void main() { colour = texture(fields[k], a); }\n");
  EXPECT_EQ(chosen.fetches.at(0).sampler, "fields[*]");
  EXPECT_THAT(texts_of(chosen, chosen.fetches[0].modifiers), Contains("uniform k"));
}

TEST(OtherSources, HaveKindsOfTheirOwn) {
  EXPECT_THAT(colour_of("colour = gl_FragCoord;", 2), ElementsAre("gl_FragCoord.z"));
  EXPECT_THAT(colour_of("colour = vec4(gl_FrontFacing ? 1.0 : 0.0);"), ElementsAre("gl_FrontFacing (branch)"));
  EXPECT_THAT(colour_of("colour = vec4(dFdx(a.x));"), ElementsAre("neighbouring pixels", "varying a.x"));
  EXPECT_THAT(colour_of("colour = vec4(textureSize(volume, 0), 1);"), ElementsAre("size of texture 'volume'"));
  EXPECT_THAT(colour_of("colour = vec4(gl_PrimitiveID);"), ElementsAre("gl_PrimitiveID"));
  EXPECT_THAT(colour_of("vec4 none; colour = none;"), ElementsAre("undefined none.x"));
}

TEST(OtherSources, InUniformBuffersAreNamedByMember) {
  const std::string before = "uniform Look { vec4 tint; float gain[2]; } look; uniform Plain { vec4 bare; };";
  EXPECT_THAT(colour_of("colour = look.tint * look.gain[1] + bare;", 1, before),
              ElementsAre("uniform buffer member Look.gain[1]", "uniform buffer member Look.tint.y",
                          "uniform buffer member bare.y"));
}

TEST(SideEffects, AreListed) {
  const StageFacts facts = facts_of(
      "#version 430\nlayout(r32f) uniform image2D seen; layout(std430) buffer Count { int hits[]; };\n"
      "layout(binding = 0) uniform atomic_uint ticks; in vec3 a; out vec4 colour;\n"
      "void main() { imageStore(seen, ivec2(a.xy), vec4(1)); atomicAdd(hits[0], 1); "
      "atomicCounterIncrement(ticks);\n"
      "hits[1] = 2; colour = imageLoad(seen, ivec2(0)) + float(hits[1]); }\n");
  std::set<SideEffectKind> kinds;
  for (const SideEffect& effect : facts.side_effects) kinds.insert(effect.kind);
  EXPECT_THAT(kinds, ElementsAre(SideEffectKind::image_store, SideEffectKind::buffer_store,
                                 SideEffectKind::buffer_atomic, SideEffectKind::atomic_counter));
  EXPECT_THAT(reaches(facts, "colour"), Contains("image seen"));
  EXPECT_THAT(facts_of(shader("colour = a;")).side_effects, IsEmpty());
}

}  // namespace
}  // namespace understudy::spu::program::testing
