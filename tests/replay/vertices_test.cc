// SPDX-License-Identifier: Apache-2.0
// Vertices in all the ways that OpenGL accepts: what a trace keeps of them draws the same image.
#include <array>
#include <cstring>

#include "replayed.h"

namespace understudy::replay_test {
namespace {

using Vertices = Replayed;

struct Vertex {
  float s, t;
  std::uint8_t colour[4];
  float x, y, z;
};

std::array<Vertex, 6> two_triangles() {
  return {{{0, 0, {255, 0, 0, 255}, -0.9F, -0.9F, 0},
           {1, 0, {0, 255, 0, 255}, 0.1F, -0.8F, 0},
           {0, 1, {0, 0, 255, 255}, -0.7F, 0.6F, 0},
           {1, 1, {255, 255, 0, 255}, 0.2F, 0.3F, 0},
           {0, 0, {0, 255, 255, 255}, 0.9F, 0.1F, 0},
           {1, 0, {200, 30, 255, 255}, 0.6F, 0.9F, 0}}};
}

void point_at(const spu::DispatchTable& gl, const Vertex* first) {
  gl.EnableClientState(GL_VERTEX_ARRAY);
  gl.EnableClientState(GL_COLOR_ARRAY);
  gl.VertexPointer(3, GL_FLOAT, sizeof(Vertex), &first->x);
  gl.ColorPointer(4, GL_UNSIGNED_BYTE, sizeof(Vertex), first->colour);
}

TEST_F(Vertices, DisplayListsNestedCalledByNamesAndExecutedWhileTheyAreMade) {
  const GLuint lists = gl().GenLists(3);
  gl().NewList(lists, GL_COMPILE);
  gl().Color3f(1, 0.5F, 0);
  gl().Begin(GL_TRIANGLES);
  gl().Vertex2f(0, 0);
  gl().Vertex2f(0.4F, 0);
  gl().Vertex2f(0, 0.4F);
  gl().End();
  gl().EndList();
  gl().NewList(lists + 1, GL_COMPILE);
  gl().Translatef(-0.5F, 0, 0);
  gl().CallList(lists);
  gl().EndList();
  auto vertices = two_triangles();
  point_at(gl(), vertices.data());
  gl().NewList(lists + 2, GL_COMPILE_AND_EXECUTE);
  gl().DrawArrays(GL_TRIANGLES, 3, 3);
  gl().EndList();
  std::memset(vertices.data(), 0, sizeof vertices);
  gl().ListBase(lists);
  const std::array<std::uint8_t, 2> names = {1, 0};
  gl().CallLists(2, GL_UNSIGNED_BYTE, names.data());
  gl().Translatef(0.3F, -0.7F, 0);
  gl().CallList(lists + 2);
  expect_same_images();
}

TEST_F(Vertices, InterleavedArraysOfTheApplicationThatChangeAfterTheDraw) {
  auto vertices = two_triangles();
  gl().InterleavedArrays(GL_T2F_C4UB_V3F, 0, vertices.data());
  gl().DrawArrays(GL_TRIANGLES, 0, 3);
  for (Vertex& vertex : vertices) vertex.x = -vertex.x;
  gl().DrawArrays(GL_TRIANGLES, 3, 3);
  std::memset(vertices.data(), 0, sizeof vertices);
  expect_same_images();
}

TEST_F(Vertices, IndicesOfTheApplication) {
  auto vertices = two_triangles();
  point_at(gl(), vertices.data());
  std::array<std::uint8_t, 3> bytes = {5, 4, 3};
  gl().DrawElements(GL_TRIANGLES, 3, GL_UNSIGNED_BYTE, bytes.data());
  std::array<std::uint16_t, 6> shorts = {0, 1, 2, 1, 2, 3};
  gl().DrawRangeElements(GL_LINE_STRIP, 0, 3, 6, GL_UNSIGNED_SHORT, shorts.data());
  bytes = {};
  shorts = {};
  expect_same_images();
}

TEST_F(Vertices, SeveralDrawsInOneCall) {
  auto vertices = two_triangles();
  point_at(gl(), vertices.data());
  const std::array<std::uint16_t, 3> first = {0, 1, 2};
  const std::array<std::uint16_t, 4> second = {3, 4, 5, 3};
  const std::array<const void*, 2> indices = {first.data(), second.data()};
  const std::array<GLsizei, 2> counts = {3, 4};
  gl().MultiDrawElements(GL_LINE_LOOP, counts.data(), GL_UNSIGNED_SHORT, indices.data(), 2);
  const std::array<GLint, 2> starts = {0, 3};
  const std::array<GLsizei, 2> lengths = {3, 3};
  gl().MultiDrawArrays(GL_TRIANGLES, starts.data(), lengths.data(), 2);
  expect_same_images();
}

TEST_F(Vertices, ElementsBetweenBeginAndEnd) {
  auto vertices = two_triangles();
  point_at(gl(), vertices.data());
  gl().Begin(GL_TRIANGLE_STRIP);
  for (const GLint element : {4, 0, 5, 2}) gl().ArrayElement(element);
  gl().Color3f(1, 1, 1);
  gl().Vertex2f(0.9F, -0.9F);
  gl().End();
  std::memset(vertices.data(), 0, sizeof vertices);
  expect_same_images();
}

TEST_F(Vertices, InBuffersThatAreMapped) {
  const auto vertices = two_triangles();
  std::array<GLuint, 3> buffers{};
  gl().GenBuffers(3, buffers.data());
  const auto draw = [&](GLuint buffer, GLint first) {
    gl().BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl().EnableClientState(GL_VERTEX_ARRAY);
    gl().EnableClientState(GL_COLOR_ARRAY);
    gl().VertexPointer(3, GL_FLOAT, sizeof(Vertex), reinterpret_cast<void*>(offsetof(Vertex, x)));
    gl().ColorPointer(4, GL_UNSIGNED_BYTE, sizeof(Vertex), reinterpret_cast<void*>(offsetof(Vertex, colour)));
    gl().DrawArrays(GL_TRIANGLES, first, 3);
  };
  gl().BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  gl().BufferData(GL_ARRAY_BUFFER, sizeof vertices, nullptr, GL_DYNAMIC_DRAW);
  std::memcpy(gl().MapBuffer(GL_ARRAY_BUFFER, GL_WRITE_ONLY), vertices.data(), sizeof vertices);
  gl().UnmapBuffer(GL_ARRAY_BUFFER);
  draw(buffers[0], 0);

  gl().BindBuffer(GL_ARRAY_BUFFER, buffers[1]);
  gl().BufferData(GL_ARRAY_BUFFER, sizeof vertices, nullptr, GL_DYNAMIC_DRAW);
  void* part =
      gl().MapBufferRange(GL_ARRAY_BUFFER, 0, sizeof vertices, GL_MAP_WRITE_BIT | GL_MAP_FLUSH_EXPLICIT_BIT);
  std::memcpy(static_cast<std::byte*>(part) + 3 * sizeof(Vertex), &vertices[3], 3 * sizeof(Vertex));
  gl().FlushMappedBufferRange(GL_ARRAY_BUFFER, 3 * sizeof(Vertex), 3 * sizeof(Vertex));
  gl().UnmapBuffer(GL_ARRAY_BUFFER);
  draw(buffers[1], 3);

  constexpr GLbitfield persistent = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  gl().BindBuffer(GL_ARRAY_BUFFER, buffers[2]);
  gl().BufferStorage(GL_ARRAY_BUFFER, sizeof vertices, nullptr, persistent);
  auto* stays = static_cast<Vertex*>(gl().MapBufferRange(GL_ARRAY_BUFFER, 0, sizeof vertices, persistent));
  for (int turn = 0; turn < 2; ++turn) {
    std::memcpy(stays, vertices.data(), sizeof vertices);
    for (int i = 0; i < 3; ++i) stays[i].y = 0.4F * vertices[std::size_t(i)].y + 0.5F * float(turn);
    draw(buffers[2], 0);
    gl().Finish();
  }
  expect_same_images();
}

TEST_F(Vertices, OfGenericAttributesInTheApplicationsMemory) {
  const char* source =
      "#version 120\n"
      "attribute vec2 place; attribute vec4 tone; varying vec4 colour;\n"
      "void main() { colour = tone; gl_Position = vec4(place, 0.0, 1.0); }\n";
  const char* fragment = "#version 120\nvarying vec4 colour; void main() { gl_FragColor = colour; }\n";
  const GLuint program = gl().CreateProgram();
  for (const auto& [type, text] : {std::pair(GL_VERTEX_SHADER, source), {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl().CreateShader(GLenum(type));
    gl().ShaderSource(shader, 1, &text, nullptr);
    gl().CompileShader(shader);
    gl().AttachShader(program, shader);
  }
  gl().BindAttribLocation(program, 0, "place");
  gl().BindAttribLocation(program, 5, "tone");
  gl().LinkProgram(program);
  gl().UseProgram(program);
  auto vertices = two_triangles();
  gl().EnableVertexAttribArray(0);
  gl().EnableVertexAttribArray(5);
  gl().VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), &vertices[0].x);
  gl().VertexAttribPointer(5, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Vertex), vertices[0].colour);
  gl().DrawArrays(GL_TRIANGLES, 0, 6);
  std::memset(vertices.data(), 0, sizeof vertices);
  expect_same_images();
}

}  // namespace
}  // namespace understudy::replay_test
