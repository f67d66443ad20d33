// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/scenes.h"

#include <array>
#include <memory>
#include <vector>

#include "dispatch/call_words.h"
#include "spu/stream/encode.h"
#include "spu/stream/event.h"
#include "tests/spu/stream/reading_driver.h"

namespace understudy::spu::testing {
namespace {

std::uint64_t at(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

/// An application, its driver and the recording of its calls.
class Scene {
 public:
  std::uint64_t make(CallId call, std::vector<std::uint64_t> words) {
    words.resize(max_parameters);
    encoder_.encode(call, words.data(), records_);
    return invoke(driver_.table(), call, words.data());
  }
  /// Records a call without making it, since this driver would crash.
  void record(CallId call, std::vector<std::uint64_t> words) { records_.append_plain(stable_id(call), words); }
  void answer(CallId call, std::uint64_t result) {
    records_.append_plain(event::answers, {{stable_id(call), result}});
  }
  void write_mapped(std::uint64_t mapping, std::span<const std::byte> data) {
    records_.append_plain(event::mapped_write, {{mapping, 4, 0}});
    records_.set(3, records_.attach(data).word());
  }
  Records take() { return std::move(records_); }

 private:
  ReadingDriver driver_;
  Records records_;
  Encoder encoder_{driver_.table(), [] {}};
};

const std::array<GLfloat, 64> numbers{};
const std::array<std::byte, 256> bytes{};
const std::array<GLuint, 6> indices = {0, 1, 2, 2, 1, 3};

Records arrays_in_memory() {
  Scene scene;
  scene.make(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  scene.make(CallId::VertexPointer, {3, GL_FLOAT, 12, at(numbers.data())});
  scene.make(CallId::EnableVertexAttribArray, {1});
  scene.make(CallId::VertexAttribPointer, {1, 4, GL_FLOAT, 0, 16, at(numbers.data())});
  scene.make(CallId::VertexAttribDivisor, {1, 2});
  scene.make(CallId::DrawArrays, {GL_TRIANGLES, 0, 3});
  scene.make(CallId::DrawArraysInstanced, {GL_TRIANGLES, 0, 3, 4});
  scene.make(CallId::DrawElements, {GL_TRIANGLES, 6, GL_UNSIGNED_INT, at(indices.data())});
  scene.make(CallId::DrawRangeElements, {GL_TRIANGLES, 0, 3, 6, GL_UNSIGNED_INT, at(indices.data())});
  scene.make(CallId::Begin, {GL_POINTS});
  scene.make(CallId::ArrayElement, {2});
  scene.make(CallId::ArrayElement, {1});
  scene.make(CallId::End, {});
  return scene.take();
}

Records arrays_in_buffers() {
  Scene scene;
  const GLuint name = 5;
  scene.make(CallId::BindBuffer, {GL_ARRAY_BUFFER, name});
  scene.make(CallId::BufferData, {GL_ARRAY_BUFFER, 256, at(numbers.data()), GL_STATIC_DRAW});
  scene.make(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  scene.make(CallId::VertexPointer, {3, GL_FLOAT, 0, 16});
  scene.make(CallId::DrawArrays, {GL_TRIANGLES, 0, 3});
  scene.make(CallId::BindBuffer, {GL_ELEMENT_ARRAY_BUFFER, 6});
  scene.make(CallId::BufferData, {GL_ELEMENT_ARRAY_BUFFER, 24, at(indices.data()), GL_STATIC_DRAW});
  scene.make(CallId::DrawElements, {GL_TRIANGLES, 3, GL_UNSIGNED_INT, 12});
  scene.make(CallId::BindBuffer, {GL_DRAW_INDIRECT_BUFFER, name});
  scene.make(CallId::DrawArraysIndirect, {GL_TRIANGLES, 32});
  scene.make(CallId::MultiDrawElementsIndirect, {GL_TRIANGLES, GL_UNSIGNED_INT, 0, 3, 24});
  scene.make(CallId::DeleteBuffers, {1, at(&name)});
  scene.record(CallId::DrawArrays, {GL_TRIANGLES, 0, 3});
  return scene.take();
}

Records pixels_in_buffers() {
  Scene scene;
  scene.make(CallId::BindBuffer, {GL_PIXEL_UNPACK_BUFFER, 7});
  scene.make(CallId::BufferData, {GL_PIXEL_UNPACK_BUFFER, 512, 0, GL_STREAM_DRAW});
  scene.make(CallId::PixelStorei, {GL_UNPACK_ROW_LENGTH, 8});
  scene.make(CallId::TexImage2D, {GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, 64});
  scene.make(CallId::CompressedTexImage2D, {GL_TEXTURE_2D, 0, GL_COMPRESSED_RGB, 4, 4, 0, 8, 128});
  scene.make(CallId::BindBuffer, {GL_PIXEL_UNPACK_BUFFER, 0});
  scene.make(CallId::TexSubImage2D,
             {GL_TEXTURE_2D, 0, 0, 0, 2, 2, GL_RGBA, GL_UNSIGNED_BYTE, at(bytes.data())});
  scene.make(CallId::CompressedTexImage2D, {GL_TEXTURE_2D, 0, GL_COMPRESSED_RGB, 4, 4, 0, 8, at(bytes.data())});
  scene.make(CallId::PixelMapfv, {GL_PIXEL_MAP_I_TO_R, 4, at(numbers.data())});
  scene.make(CallId::BindBuffer, {GL_PIXEL_PACK_BUFFER, 8});
  scene.make(CallId::BufferData, {GL_PIXEL_PACK_BUFFER, 512, 0, GL_STREAM_READ});
  scene.make(CallId::ReadPixels, {0, 0, 4, 4, GL_RGBA, GL_UNSIGNED_BYTE, 32});
  scene.make(CallId::GetTexImage, {GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, 16});
  scene.make(CallId::BindBuffer, {GL_PIXEL_PACK_BUFFER, 0});
  std::array<std::byte, 1024> room{};
  scene.make(CallId::ReadPixels, {0, 0, 4, 4, GL_RGBA, GL_UNSIGNED_BYTE, at(room.data())});
  scene.make(CallId::GetTexImage, {GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, at(room.data())});
  return scene.take();
}

Records mapped_buffers() {
  Scene scene;
  scene.make(CallId::BindBuffer, {GL_ARRAY_BUFFER, 5});
  scene.make(CallId::BufferData, {GL_ARRAY_BUFFER, 64, 0, GL_STATIC_DRAW});
  const std::uint64_t whole = scene.make(CallId::MapBuffer, {GL_ARRAY_BUFFER, GL_WRITE_ONLY});
  scene.answer(CallId::MapBuffer, whole);
  scene.write_mapped(whole, std::span(bytes).first(32));
  scene.make(CallId::UnmapBuffer, {GL_ARRAY_BUFFER});
  const std::uint64_t part = scene.make(CallId::MapBufferRange, {GL_ARRAY_BUFFER, 16, 32, GL_MAP_WRITE_BIT});
  scene.answer(CallId::MapBufferRange, part);
  scene.write_mapped(part, std::span(bytes).first(8));
  scene.make(CallId::BufferData, {GL_ARRAY_BUFFER, 16, 0, GL_STATIC_DRAW});
  scene.write_mapped(part, std::span(bytes).first(8));
  return scene.take();
}

Records feedback() {
  Scene scene;
  std::array<GLuint, 64> room{};
  scene.make(CallId::FeedbackBuffer, {64, GL_3D_COLOR, at(room.data())});
  scene.make(CallId::SelectBuffer, {64, at(room.data())});
  for (const GLenum mode : {GL_FEEDBACK, GL_SELECT, GL_RENDER}) scene.make(CallId::RenderMode, {mode});
  scene.make(CallId::FeedbackBuffer, {16, GL_2D, at(room.data())});
  return scene.take();
}

Records texts_and_lists() {
  Scene scene;
  const std::array<const char*, 2> sources = {"void main()", "{}"};
  const std::array<GLint, 2> lengths = {11, -1};
  scene.make(CallId::ShaderSource, {1, 2, at(sources.data()), at(lengths.data())});
  scene.make(CallId::ShaderSource, {1, 2, at(sources.data()), 0});
  scene.make(CallId::ObjectLabel, {GL_BUFFER, 1, 4, at("name")});
  scene.make(CallId::NamedStringARB,
             {GL_SHADER_INCLUDE_ARB, ~std::uint64_t(0), at("/a"), ~std::uint64_t(0), at("b")});
  scene.make(CallId::PushGroupMarkerEXT, {0, at("group")});
  const std::array<const void*, 2> lists = {indices.data(), indices.data() + 3};
  const std::array<GLsizei, 2> counts = {3, 3};
  scene.make(CallId::MultiDrawElements,
             {GL_TRIANGLES, at(counts.data()), GL_UNSIGNED_INT, at(lists.data()), counts.size()});
  scene.make(CallId::MultiDrawArrays, {GL_TRIANGLES, at(counts.data()), at(counts.data()), counts.size()});
  scene.make(CallId::CallLists, {4, GL_UNSIGNED_BYTE, at(bytes.data())});
  scene.make(CallId::Map1f, {GL_MAP1_VERTEX_3, 0, 0, 3, 4, at(numbers.data())});
  scene.make(CallId::Lightfv, {GL_LIGHT0, GL_POSITION, at(numbers.data())});
  scene.make(CallId::NewList, {3, GL_COMPILE});
  scene.make(CallId::Begin, {GL_POINTS});
  scene.make(CallId::EndList, {});
  scene.make(CallId::CallList, {3});
  scene.make(CallId::TexImage2D,
             {GL_TEXTURE_2D, 0, GL_RGBA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, at(bytes.data())});
  scene.make(CallId::End, {});
  return scene.take();
}

Records questions() {
  Scene scene;
  std::array<std::byte, 256> room{};
  scene.make(CallId::ProgramStringARB,
             {GL_VERTEX_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB, 200, at(bytes.data())});
  scene.make(CallId::GetProgramStringARB, {GL_VERTEX_PROGRAM_ARB, GL_PROGRAM_STRING_ARB, at(room.data())});
  scene.make(CallId::GetIntegerv, {GL_VIEWPORT, at(room.data())});
  scene.make(CallId::GetPointerv, {GL_VERTEX_ARRAY_POINTER, at(room.data())});
  scene.make(CallId::GetActiveUniformBlockiv, {1, 0, GL_UNIFORM_BLOCK_ACTIVE_UNIFORM_INDICES, at(room.data())});
  scene.make(CallId::GetShaderInfoLog, {1, 64, at(room.data()), at(room.data()) + 8});
  const std::uint64_t values = at(room.data());
  scene.make(CallId::GetDebugMessageLog, {1, 0, values, values, values, values, values, 0});
  scene.make(CallId::UseProgram, {4});
  scene.make(CallId::GetUniformLocation, {4, at("matrix")});
  scene.answer(CallId::GetUniformLocation, 2);
  scene.make(CallId::UniformMatrix4fv, {2, 1, 0, at(numbers.data())});
  scene.make(CallId::FenceSync, {GL_SYNC_GPU_COMMANDS_COMPLETE, 0});
  scene.answer(CallId::FenceSync, 0x5000);
  scene.make(CallId::DeleteSync, {0x5000});
  scene.make(CallId::BindBuffer, {GL_QUERY_BUFFER, 9});
  scene.make(CallId::GetQueryObjectiv, {1, GL_QUERY_RESULT, at(room.data())});
  return scene.take();
}

}  // namespace

std::map<std::string, Records> scenes() {
  std::map<std::string, Records> all;
  all["arrays_in_memory"] = arrays_in_memory();
  all["arrays_in_buffers"] = arrays_in_buffers();
  all["pixels_in_buffers"] = pixels_in_buffers();
  all["mapped_buffers"] = mapped_buffers();
  all["feedback"] = feedback();
  all["texts_and_lists"] = texts_and_lists();
  all["questions"] = questions();
  return all;
}

}  // namespace understudy::spu::testing
