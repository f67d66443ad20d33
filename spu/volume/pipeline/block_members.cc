// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/block_members.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>

#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/active_uniform.h"

namespace understudy::spu {
namespace {

/// OpenGL guarantees a 64th of this size; some drivers allow any.
constexpr GLint most_block_bytes = 1 << 20;
/// The elements of a longer array form one member.
constexpr std::size_t most_apart = 64;

struct Extent {
  std::size_t columns = 1;  ///< of a matrix
  std::size_t rows = 1;     ///< or components of a vector
  std::size_t bytes_a_component = 4;
};

Extent extent_of(GLenum type) {
  switch (type) {
    case GL_FLOAT:
    case GL_INT:
    case GL_UNSIGNED_INT:
    case GL_BOOL:
      return {};
    case GL_FLOAT_VEC2:
    case GL_INT_VEC2:
    case GL_UNSIGNED_INT_VEC2:
    case GL_BOOL_VEC2:
      return {1, 2};
    case GL_FLOAT_VEC3:
    case GL_INT_VEC3:
    case GL_UNSIGNED_INT_VEC3:
    case GL_BOOL_VEC3:
      return {1, 3};
    case GL_FLOAT_VEC4:
    case GL_INT_VEC4:
    case GL_UNSIGNED_INT_VEC4:
    case GL_BOOL_VEC4:
      return {1, 4};
    case GL_FLOAT_MAT2:
      return {2, 2};
    case GL_FLOAT_MAT2x3:
      return {2, 3};
    case GL_FLOAT_MAT2x4:
      return {2, 4};
    case GL_FLOAT_MAT3x2:
      return {3, 2};
    case GL_FLOAT_MAT3:
      return {3, 3};
    case GL_FLOAT_MAT3x4:
      return {3, 4};
    case GL_FLOAT_MAT4x2:
      return {4, 2};
    case GL_FLOAT_MAT4x3:
      return {4, 3};
    case GL_FLOAT_MAT4:
      return {4, 4};
    case GL_DOUBLE:
      return {1, 1, 8};
    case GL_DOUBLE_VEC2:
      return {1, 2, 8};
    case GL_DOUBLE_VEC3:
      return {1, 3, 8};
    case GL_DOUBLE_VEC4:
      return {1, 4, 8};
    default:
      return {4, 4, 8};  // the largest: a smaller one then includes what follows it
  }
}

/// Returns a GL_UNIFORM_* property of one uniform.
std::size_t asked(const DispatchTable& gl, GLuint program, GLuint uniform, GLenum what) {
  GLint answer = 0;
  gl.GetActiveUniformsiv(program, 1, &uniform, what, &answer);
  return std::size_t(std::max(answer, 0));
}

std::size_t bytes_of_element(const DispatchTable& gl, GLuint program, GLuint uniform, GLenum type) {
  Extent extent = extent_of(type);
  if (asked(gl, program, uniform, GL_UNIFORM_IS_ROW_MAJOR) != 0) std::swap(extent.columns, extent.rows);
  const std::size_t column = extent.rows * extent.bytes_a_component;
  const std::size_t stride = asked(gl, program, uniform, GL_UNIFORM_MATRIX_STRIDE);
  return (extent.columns - 1) * std::max(stride, column) + column;
}

/// Adds a uniform of a block, element by element.
void append_elements(const DispatchTable& gl, GLuint program, GLuint uniform, GLuint block,
                     std::vector<BlockMember>& members) {
  const auto [name, type, listed] = active_uniform(gl, program, uniform);
  const std::size_t elements = std::size_t(std::max(listed, 1));
  const std::size_t stride = asked(gl, program, uniform, GL_UNIFORM_ARRAY_STRIDE);
  const std::size_t bytes = bytes_of_element(gl, program, uniform, type);
  const std::size_t offset = asked(gl, program, uniform, GL_UNIFORM_OFFSET);
  if (!name.ends_with("[0]")) {
    members.push_back({name, block, offset, bytes});
    return;
  }
  const std::string array = name.substr(0, name.size() - 3);
  if (elements > most_apart) {
    members.push_back({array, block, offset, (elements - 1) * stride + bytes});
    return;
  }
  for (std::size_t i = 0; i < elements; ++i)
    members.push_back({fmt::format("{}[{}]", array, i), block, offset + i * stride, bytes});
}

}  // namespace

std::vector<BlockMember> block_members(const GlContext& context, GLuint program) {
  constexpr int first_version_with_blocks = 310;
  if (context.version < first_version_with_blocks) return {};
  const DispatchTable& gl = *context.gl;
  GLint count = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
  std::vector<BlockMember> members;
  for (GLuint uniform = 0; uniform < GLuint(count); ++uniform) {
    GLint block = -1;
    gl.GetActiveUniformsiv(program, 1, &uniform, GL_UNIFORM_BLOCK_INDEX, &block);
    if (block < 0) continue;
    append_elements(gl, program, uniform, GLuint(block), members);
  }
  return members;
}

std::optional<std::vector<std::byte>> block_contents(const DispatchTable& gl, GLuint program, GLuint block) {
  GLint binding = 0, bytes = 0, buffer = 0, bound = 0, mapped = 0, access = 0;
  GLint64 start = 0, room = 0;
  gl.GetActiveUniformBlockiv(program, block, GL_UNIFORM_BLOCK_BINDING, &binding);
  gl.GetActiveUniformBlockiv(program, block, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
  gl.GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, GLuint(binding), &buffer);
  gl.GetInteger64i_v(GL_UNIFORM_BUFFER_START, GLuint(binding), &start);
  if (buffer == 0 || bytes <= 0 || bytes > most_block_bytes) return std::nullopt;
  gl.GetIntegerv(GL_COPY_READ_BUFFER_BINDING, &bound);
  gl.BindBuffer(GL_COPY_READ_BUFFER, GLuint(buffer));
  gl.GetBufferParameteriv(GL_COPY_READ_BUFFER, GL_BUFFER_MAPPED, &mapped);
  gl.GetBufferParameteriv(GL_COPY_READ_BUFFER, GL_BUFFER_ACCESS_FLAGS, &access);
  gl.GetBufferParameteri64v(GL_COPY_READ_BUFFER, GL_BUFFER_SIZE, &room);
  std::optional<std::vector<std::byte>> contents;
  if ((mapped == GL_FALSE || (access & GL_MAP_PERSISTENT_BIT) != 0) && start < room) {
    contents.emplace(std::size_t(std::min(GLint64(bytes), room - start)));
    gl.GetBufferSubData(GL_COPY_READ_BUFFER, GLintptr(start), GLsizeiptr(contents->size()), contents->data());
  }
  gl.BindBuffer(GL_COPY_READ_BUFFER, GLuint(bound));
  return contents;
}

void append_exactly(std::uint64_t number, std::vector<float>& values) {
  for (int part = 0; part < 4; ++part, number >>= 16) values.push_back(float(number & 0xffff));
}

void append_digest(std::span<const std::byte> bytes, std::vector<float>& values) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  append_exactly(std::hash<std::string_view>()(text), values);
}

}  // namespace understudy::spu
