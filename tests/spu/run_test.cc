// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/run.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dispatch/pass_through.h"
#include "spu/stream/plain_calls.h"
#include "spu/volume/observation/client_arrays.h"

namespace understudy::spu {
namespace {

std::vector<std::string> heard;

void hear(const char* name, std::initializer_list<float> values) {
  std::string text = name;
  for (const float v : values) text += " " + std::to_string(int(v * 100));
  heard.push_back(text);
}

/// A driver that records the few calls that runs of slices consist of.
DispatchTable listening_driver() {
  DispatchTable table{};
  table.Begin = [](GLenum mode) { hear("Begin", {float(mode) / 100}); };
  table.End = [] { hear("End", {}); };
  table.Vertex4f = [](GLfloat x, GLfloat y, GLfloat z, GLfloat w) { hear("Vertex", {x, y, z, w}); };
  table.MultiTexCoord4f = [](GLenum unit, GLfloat s, GLfloat t, GLfloat r, GLfloat q) {
    hear("TexCoord", {float(unit - GL_TEXTURE0) / 100, s, t, r, q});
  };
  table.Color4f = [](GLfloat r, GLfloat g, GLfloat b, GLfloat a) { hear("Color", {r, g, b, a}); };
  table.DrawElements = [](GLenum, GLsizei count, GLenum, const void*) {
    hear("DrawElements", {float(count) / 100});
  };
  table.CallList = [](GLuint list) { hear("CallList", {float(list) / 100}); };
  return table;
}

TEST(Run, ReplaysInOrderWithElementDrawsBetween) {
  heard.clear();
  Records calls;
  spu::Run run(Pipeline{}, calls, false);
  append_call(run.calls(), &DispatchTable::CallList, 4);
  run.draw_elements(GL_TRIANGLES, std::array{spu::ElementPart{.count = 6}}, GL_UNSIGNED_INT);
  append_call(run.calls(), &DispatchTable::CallList, 5);
  run.replay(listening_driver());
  EXPECT_EQ(heard, (std::vector<std::string>{"CallList 4", "DrawElements 6", "CallList 5"}));
}

TEST(Run, CountsTheTrianglesOfElementDraws) {
  Records calls;
  spu::Run run(Pipeline{}, calls, false);
  run.draw_elements(GL_TRIANGLES, std::array{spu::ElementPart{.count = 37}}, GL_UNSIGNED_INT);
  run.draw_elements(GL_TRIANGLE_STRIP, std::array{spu::ElementPart{.count = 14}, spu::ElementPart{.count = 2}},
                    GL_UNSIGNED_INT);
  run.draw_elements_instanced(GL_TRIANGLE_FAN, {.count = 4}, GL_UNSIGNED_INT, 3);
  EXPECT_EQ(run.triangles(), std::size_t(12 + 12 + 6));
}

TEST(Run, LeavesOtherTrianglesToTheDriver) {
  Records calls;
  spu::Run quads(Pipeline{}, calls, false);
  quads.draw_elements(GL_QUADS, std::array{spu::ElementPart{.count = 8}}, GL_UNSIGNED_INT);
  EXPECT_EQ(quads.triangles(), std::nullopt);
  spu::Run with_list(Pipeline{}, calls, false);
  with_list.draw_elements(GL_TRIANGLES, std::array{spu::ElementPart{.count = 6}}, GL_UNSIGNED_INT);
  with_list.call_list(4);
  EXPECT_EQ(with_list.triangles(), std::nullopt);
}

TEST(ClientArrays, AreCapturedAtTheTimeOfTheCall) {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0};
  std::vector<double> coordinates = {0, 0, 0.5, 1, 0, 0.5, 1, 1, 0.5};
  std::vector<std::uint8_t> colours = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 51};
  ArraySources sources;
  sources.client_memory = true;
  using Role = MemoryArray::Role;
  const auto bytes = [](auto& v) { return reinterpret_cast<const std::byte*>(v.data()); };
  sources.arrays = {
      {.role = Role::texture_coordinate,
       .index = 0,
       .components = 3,
       .type = GL_DOUBLE,
       .stride = 24,
       .first = bytes(coordinates)},
      {.role = Role::colour,
       .components = 4,
       .type = GL_UNSIGNED_BYTE,
       .normalised = true,
       .stride = 4,
       .first = bytes(colours)},
      {.role = Role::vertex, .components = 3, .type = GL_FLOAT, .stride = 12, .first = bytes(positions)}};
  Records calls;
  spu::Run run(Pipeline{}, calls, false);
  append_elements(run.calls(), sources, GL_TRIANGLES, {2, 0});
  positions.assign(9, 9.0F);  // the application reuses its buffer
  heard.clear();
  run.replay(listening_driver());
  EXPECT_EQ(heard, (std::vector<std::string>{"Begin 4", "TexCoord 0 100 100 50 100", "Color 0 0 100 20",
                                             "Vertex 100 100 0 100", "TexCoord 0 0 0 50 100",
                                             "Color 100 0 0 100", "Vertex 0 0 0 100", "End"}));
}

}  // namespace
}  // namespace understudy::spu
