// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/bound_buffers.h"

#include <algorithm>
#include <array>
#include <limits>

#include "spu/state_value.h"
#include "spu/stream/mapping_calls.h"

namespace understudy::spu {
namespace {

constexpr std::array<BufferPoint, 15> points = {{
    {GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING},
    {GL_ELEMENT_ARRAY_BUFFER, GL_ELEMENT_ARRAY_BUFFER_BINDING},
    {GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING},
    {GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING},
    {GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING},
    {GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING},
    {GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING},
    {GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING},
    {GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING},
    {GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING},
    {GL_ATOMIC_COUNTER_BUFFER, GL_ATOMIC_COUNTER_BUFFER_BINDING},
    {GL_TRANSFORM_FEEDBACK_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING},
    // The target is also the name of its binding (OpenGL 4.6, table 23.53).
    {GL_TEXTURE_BUFFER, GL_TEXTURE_BUFFER},
    {GL_QUERY_BUFFER, GL_QUERY_BUFFER_BINDING},
    {GL_PARAMETER_BUFFER, GL_PARAMETER_BUFFER_BINDING},
}};

BufferPoint point_of(GLenum target) {
  return {target, binding_of_target(target)};
}

}  // namespace

GLenum binding_of_target(GLenum target) noexcept {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [&](const BufferPoint& point) { return point.target == target; });
  return found == points.end() ? GLenum(GL_NONE) : found->binding;
}

GLenum target_of_binding(GLenum binding) noexcept {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [&](const BufferPoint& point) { return point.binding == binding; });
  return found == points.end() ? GLenum(GL_NONE) : found->target;
}

std::optional<BufferPoint> buffer_point(ExtentRule rule) noexcept {
  switch (rule) {
    case ExtentRule::image:
    case ExtentRule::counted_or_unpack:
      return point_of(GL_PIXEL_UNPACK_BUFFER);
    case ExtentRule::image_out:
      return point_of(GL_PIXEL_PACK_BUFFER);
    case ExtentRule::client_array:
      return point_of(GL_ARRAY_BUFFER);
    case ExtentRule::indices:
    case ExtentRule::index_lists:
      return point_of(GL_ELEMENT_ARRAY_BUFFER);
    case ExtentRule::indirect:
      return point_of(GL_DRAW_INDIRECT_BUFFER);
    default:
      return std::nullopt;
  }
}

std::optional<GLint> asked(const DispatchTable& gl, GLenum name) {
  constexpr GLint no_answer = std::numeric_limits<GLint>::min();
  GLint value = no_answer;
  gl.GetIntegerv(name, &value);
  return value == no_answer ? std::nullopt : std::optional(value);
}

GLuint buffer_of(const DispatchTable& gl, CallId call, const std::uint64_t* words) {
  if (is_by_name(call)) return GLuint(words[0]);
  const GLenum binding = binding_of_target(GLenum(words[0]));
  return binding == GL_NONE ? 0 : GLuint(state_value(gl, binding));
}

BufferMapping mapping_of(const DispatchTable& gl, GLuint buffer) {
  BufferMapping mapping;
  const auto before = asked(gl, GL_ARRAY_BUFFER_BINDING);
  if (!before || !gl.IsBuffer(buffer)) return mapping;
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
  gl.GetBufferPointerv(GL_ARRAY_BUFFER, GL_BUFFER_MAP_POINTER, &mapping.first);
  gl.GetBufferParameteriv(GL_ARRAY_BUFFER, GL_BUFFER_ACCESS, &mapping.access);
  gl.BindBuffer(GL_ARRAY_BUFFER, GLuint(*before));
  return mapping;
}

std::uint64_t bound_bytes(const DispatchTable& gl, GLenum target) {
  GLint64 bytes = 0;
  if (gl.GetBufferParameteri64v != nullptr) gl.GetBufferParameteri64v(target, GL_BUFFER_SIZE, &bytes);
  if (bytes > 0) return std::uint64_t(bytes);
  // Before OpenGL 3.2.
  GLint few = 0;
  gl.GetBufferParameteriv(target, GL_BUFFER_SIZE, &few);
  return std::uint64_t(std::max(few, 0));
}

}  // namespace understudy::spu
