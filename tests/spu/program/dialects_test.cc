// SPDX-License-Identifier: Apache-2.0
// Every dialect that a driver may receive: all GLSL versions, several shaders per stage, and stages other than
// fragment.
#include <gmock/gmock.h>

#include <thread>

#include "spu/volume/program/influences.h"
#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

TEST(Dialects, BeginWith110WhereTheTextDoesNotSay) {
  const StageFacts facts = facts_of(
      "uniform sampler3D volume; uniform sampler1D table;\n"
      "void main() { gl_FragColor = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz).a) * gl_Color; }\n");
  EXPECT_EQ(facts.version, 110);
  EXPECT_THAT(reaches(facts, "gl_FragColor", 3), ElementsAre("texel of 'table'.w", "varying gl_Color.w"));
}

TEST(Dialects, OfAllVersionsAreRead) {
  for (const std::string version : {"130", "140", "150", "330", "400", "410", "420", "430", "440", "450", "460",
                                    "150 compatibility", "450 compatibility", "330 core"}) {
    const StageFacts facts = facts_of("#version " + version +
                                      "\nuniform sampler3D volume; in vec3 tc; out vec4 colour;\n"
                                      "void main() { colour = texture(volume, tc); }\n");
    EXPECT_THAT(reaches(facts, "colour"), ElementsAre("texel of 'volume'.x")) << version;
  }
}

TEST(Dialects, OfEmbeddedSystemsAreRead) {
  const StageFacts three = facts_of(
      "#version 300 es\nprecision highp float; precision highp sampler3D;\n"
      "uniform sampler3D volume; in vec3 tc; layout(location = 0) out vec4 colour;\n"
      "void main() { colour = texture(volume, tc); }\n");
  EXPECT_THAT(reaches(three, "colour"), ElementsAre("texel of 'volume'.x"));
  const StageFacts one = facts_of(
      "#version 100\nprecision mediump float; uniform sampler2D atlas; varying vec2 tc;\n"
      "void main() { gl_FragColor = texture2D(atlas, tc); }\n");
  EXPECT_THAT(reaches(one, "gl_FragColor"), ElementsAre("texel of 'atlas'.x"));
}

TEST(Dialects, KnowTheStateOfFixedFunction) {
  const StageFacts facts = facts_of(
      "#version 120\nvoid main() { gl_FragData[1] = vec4(gl_Fog.density * gl_FogFragCoord, "
      "gl_LightSource[2].ambient.y,"
      " gl_TextureMatrix[1][3][0], gl_TexCoord[2].q); }\n");
  EXPECT_THAT(reaches(facts, "gl_FragData[1]", 0),
              ElementsAre("uniform gl_Fog.density", "varying gl_FogFragCoord"));
  EXPECT_THAT(reaches(facts, "gl_FragData[1]", 1), ElementsAre("uniform gl_LightSource[2].ambient.y"));
  EXPECT_THAT(reaches(facts, "gl_FragData[1]", 2), ElementsAre("uniform gl_TextureMatrix[1][3][0]"));
  EXPECT_THAT(reaches(facts, "gl_FragData[1]", 3), ElementsAre("varying gl_TexCoord[2].w"));
}

TEST(Dialects, KnowEveryKindOfSampler) {
  const StageFacts facts = facts_of(
      "#version 400\nuniform usampler3D natural; uniform isampler2DArray layers; uniform sampler1DArray rows;\n"
      "uniform samplerBuffer list; uniform sampler2DRect pixels; uniform samplerCube sky; uniform "
      "sampler2DShadow depth;\n"
      "in vec4 a; out vec4 colour; void main() { colour = vec4(texture(natural, a.xyz)) + vec4(texture(layers, "
      "a.xyz))"
      " + texture(rows, a.xy) + texelFetch(list, int(a.x)) + texture(pixels, a.xy) + texture(sky, a.xyz)"
      " + vec4(texture(depth, a.xyw)) + textureGather(pixels, a.xy); }\n");
  std::vector<std::string> types;
  for (const Fetch& fetch : facts.fetches) types.push_back(text(fetch.type));
  EXPECT_THAT(types, ElementsAre("usampler3D", "isampler2DArray", "sampler1DArray", "samplerBuffer",
                                 "sampler2DRect", "samplerCube", "sampler2DShadow", "sampler2DRect"));
  EXPECT_EQ(facts.fetches[1].coordinate.size(), 3U);
  EXPECT_EQ(facts.fetches[2].coordinate.size(), 2U);
  EXPECT_EQ(facts.fetches[6].coordinate.size(), 2U);
  EXPECT_THAT(texts_of(facts, facts.fetches[6].modifiers), ElementsAre("varying a.w"));
  EXPECT_EQ(facts.fetches[7].function, FetchFunction::gathered);
}

TEST(Dialects, SayInterpolationAndLocations) {
  const StageFacts facts = facts_of(
      "#version 330\nflat in int label; noperspective in vec2 p; centroid in vec3 c; smooth in vec4 tc[2];\n"
      "layout(location = 0, index = 1) out vec4 second; layout(location = 3) out vec2 more;\n"
      "void main() { second = tc[1]; more = p; }\n");
  ASSERT_EQ(facts.inputs.size(), 4U);
  for (const Input& input : facts.inputs) {
    EXPECT_EQ(input.interpolation, input.name == "label" ? Interpolation::flat
                                   : input.name == "p"   ? Interpolation::no_perspective
                                                         : Interpolation::smooth);
    EXPECT_EQ(input.integer, input.name == "label");
    EXPECT_EQ(input.centroid, input.name == "c");
    EXPECT_EQ(input.elements, input.name == "tc" ? 2 : 1);
  }
  for (const Output& output : facts.outputs) {
    EXPECT_EQ(output.location, output.name == "more" ? 3 : 0);
    EXPECT_EQ(output.index, output.name == "second" ? 1 : 0);
  }
}

TEST(Dialects, NameTheMembersOfInterfaceBlocks) {
  const StageFacts facts = facts_of(
      "#version 440\nin Named { flat int label; noperspective vec2 place; mat2 turned[3]; } read;\n"
      "in Nameless { vec4 tint; };\n"
      "layout(location = 5) in Placed { vec3 there; } placed; in Several { vec3 each; } several[2];\n"
      "out vec4 colour;\n"
      "void main() { colour = tint + vec4(read.place, float(read.label), read.turned[1][0].x)\n"
      "  + vec4(placed.there + several[1].each, 1.0); }\n");
  std::vector<std::string> members;
  for (const Input& input : facts.inputs) {
    if (input.block.empty()) continue;
    members.push_back(input.block + ": " + input.name + " " + std::to_string(input.components) + "x" +
                      std::to_string(input.elements));
    EXPECT_EQ(input.interpolation, input.name == "Named.label"   ? Interpolation::flat
                                   : input.name == "Named.place" ? Interpolation::no_perspective
                                                                 : Interpolation::smooth);
    EXPECT_EQ(input.integer, input.name == "Named.label");
  }
  // Blocks with locations, and arrays of blocks, are not split into members.
  EXPECT_THAT(members, UnorderedElementsAre("Named: Named.label 1x1", "Named: Named.place 2x1",
                                            "Named: Named.turned[0] 4x3", "Nameless: tint 4x1"));
}

TEST(Dialects, LinkSeveralShadersOfAStage) {
  const std::vector<std::string> sources{
      "#version 120\nvarying vec3 tc; vec4 classified(float v); uniform sampler3D volume;\n"
      "void main() { gl_FragColor = classified(texture3D(volume, tc).r); }\n",
      "#version 120\nuniform sampler1D table; vec4 classified(float v) { return texture1D(table, v); }\n"};
  const StageFinding finding = analyse(Stage::fragment, sources);
  ASSERT_TRUE(std::holds_alternative<StageFacts>(finding)) << std::get<Failure>(finding).what;
  EXPECT_THAT(reaches(std::get<StageFacts>(finding), "gl_FragColor"), ElementsAre("texel of 'table'.x"));
}

TEST(Dialects, AskForTheDriversExtensions) {
  const std::vector<std::string> sources{
      "#version 330\n#if defined(GL_ARB_gpu_shader5) && \\\n __VERSION__ >= 330\n#define picked "
      "a\n#else\n#define picked b\n#endif\n"
      "in vec4 a, b; out vec4 colour; void main() { colour = picked;\n#ifdef GL_ES\ncolour.x = "
      "0.0;\n#endif\n}\n"};
  const std::vector<std::string> many{"GL_EXT_other", "GL_ARB_gpu_shader5"};
  const std::vector<std::string> none;
  const StageFinding with = analyse(Stage::fragment, sources, {}, many);
  const StageFinding without = analyse(Stage::fragment, sources, {}, none);
  EXPECT_THAT(reaches(std::get<StageFacts>(with), "colour"), ElementsAre("varying a.x"));
  EXPECT_THAT(reaches(std::get<StageFacts>(without), "colour"), ElementsAre("varying b.x"));
  EXPECT_THAT(what_fails(sources[0]), HasSubstr("depends on GL_ARB_gpu_shader5"));
  EXPECT_THAT(what_fails("#ifdef __GLSL_CG_DATA_TYPES\n#endif\nvoid main() {}"),
              HasSubstr("__GLSL_CG_DATA_TYPES"));
  EXPECT_THAT(what_fails("#define __own 1\n#if __own\n#endif\nvoid main() {}"), IsEmpty());
}

TEST(VertexStages, SayWhatVaryingsComeFrom) {
  const StageFacts facts = facts_of(
      "#version 120\nuniform vec4 tint; uniform mat4 m; attribute vec3 p; varying vec3 tc; varying vec4 "
      "flat_colour;\n"
      "void main() { tc = p; flat_colour = tint; gl_TexCoord[1] = m * gl_Vertex; gl_Position = ftransform();\n"
      "gl_FrontColor = gl_Color; }\n",
      Stage::vertex);
  EXPECT_THAT(reaches(facts, "tc", 2), ElementsAre("attribute p.z"));
  EXPECT_THAT(reaches(facts, "flat_colour", 1), ElementsAre("uniform tint.y"));
  EXPECT_THAT(reaches(facts, "gl_Position", 0), Contains("attribute gl_Vertex.w"));
  EXPECT_THAT(reaches(facts, "gl_Position", 0), Contains("uniform gl_ModelViewProjectionMatrix[3][0]"));
  EXPECT_TRUE(
      is_constant_over_draw(facts, {.kind = SourceKind::varying, .name = "flat_colour", .component = 1}));
  EXPECT_FALSE(is_constant_over_draw(facts, {.kind = SourceKind::varying, .name = "tc", .component = 1}));
  EXPECT_FALSE(is_constant_over_draw(facts, {.kind = SourceKind::varying, .name = "gl_Color", .component = 1}));
  EXPECT_FALSE(is_constant_over_draw(facts, {.kind = SourceKind::varying, .name = "nowhere"}));
}

TEST(VertexStages, OfLaterVersionsHaveBlocks) {
  const StageFacts facts = facts_of(
      "#version 450\nin vec3 p; out Data { vec3 tc; } data; layout(location = 2) uniform mat4 m;\n"
      "void main() { data.tc = p; gl_Position = m * vec4(p, gl_VertexID); }\n",
      Stage::vertex);
  EXPECT_THAT(reaches(facts, "Data.tc", 0), ElementsAre("attribute p.x"));
  EXPECT_THAT(reaches(facts, "gl_Position", 3), Contains("gl_VertexID"));
}

TEST(GeometryStages, SayWhatTheyEmit) {
  const StageFacts facts = facts_of(
      "#version 150\nlayout(triangles) in; layout(triangle_strip, max_vertices = 6) out; in vec3 tc[]; out "
      "vec3 place;\n"
      "out vec3 other; void main() { for (int i = 0; i < 3; ++i) { place = tc[i]; other = tc[0];\n"
      "gl_Position = gl_in[i].gl_Position; EmitVertex(); } other = vec3(0); EndPrimitive(); }\n",
      Stage::geometry);
  EXPECT_THAT(reaches(facts, "place", 1), Contains("varying tc[2].y"));
  EXPECT_THAT(reaches(facts, "other", 1), ElementsAre("varying tc[0].y"));
}

TEST(Failures, AreTheFrontEndsWords) {
  EXPECT_THAT(what_fails("void main() { gl_FragColor = nothing; }"),
              HasSubstr("'nothing' : undeclared identifier"));
  EXPECT_THAT(what_fails("#version 120\n#extension GL_EXT_gpu_shader4 : require\nvoid main() {}"),
              HasSubstr("extension not supported: GL_EXT_gpu_shader4"));
  EXPECT_THAT(what_fails(""), Not(IsEmpty()));
  EXPECT_THAT(what_fails("void helper() {}"), HasSubstr("main"));
}

TEST(Failures, ComeBeforeTheFrontEndIsInTrouble) {
  EXPECT_THAT(what_fails("void main() { gl_FragColor = vec4(" + std::string(5000, '(') + "1.0" +
                         std::string(5000, ')') + "); }"),
              HasSubstr("too large"));
  EXPECT_THAT(what_fails(std::string(2'000'000, ' ')), HasSubstr("too large"));
  std::string doubling = "float f0(float x) { return x; }\n";
  for (int i = 1; i < 40; ++i) {
    const std::string called = "f" + std::to_string(i - 1) + "(x)";
    doubling.append("float f").append(std::to_string(i)).append("(float x) { return ");
    doubling.append(called).append(" + ").append(called).append("; }\n");
  }
  EXPECT_THAT(what_fails(doubling + "void main() { gl_FragColor = vec4(f39(1.0)); }"), HasSubstr("too large"));
}

TEST(Analysis, IsSafeFromSeveralThreads) {
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([i] {
      for (int k = 0; k < 20; ++k) {
        const std::string component = std::string(1, "xyzw"[(i + k) % 4]);
        EXPECT_THAT(colour_of("colour = vec4(a." + component + ");"), ElementsAre("varying a." + component));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace understudy::spu::program::testing
