// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/unknown_answers.h"

#include <algorithm>
#include <string_view>

namespace understudy::spu {
namespace {

/// Larger than any state of OpenGL.
constexpr std::size_t most_state_bytes = std::size_t(64) * 1024;
/// A surface of 64 by 64 control points of four doubles.
constexpr std::size_t most_map_bytes = std::size_t(64) * 64 * 4 * sizeof(double);

std::size_t positive(GLint value) {
  return std::size_t(std::max(value, 0));
}

std::size_t assembly_text_bytes(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  GLint length = 0;
  if (call == CallId::GetProgramStringARB && gl.GetProgramivARB != nullptr)
    gl.GetProgramivARB(GLenum(words[0]), GL_PROGRAM_LENGTH_ARB, &length);
  if (call == CallId::GetNamedProgramStringEXT && gl.GetNamedProgramivEXT != nullptr)
    gl.GetNamedProgramivEXT(GLuint(words[0]), GLenum(words[1]), GL_PROGRAM_LENGTH_ARB, &length);
  if (call == CallId::GetProgramStringNV && gl.GetProgramivNV != nullptr)
    gl.GetProgramivNV(GLuint(words[0]), GL_PROGRAM_LENGTH_NV, &length);
  return positive(length) + 1;
}

/// A uniform block, or a buffer of counters, has at most as many members as its program has uniforms.
std::size_t uniform_list_bytes(GLuint program, const DispatchTable& gl) {
  GLint uniforms = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
  return positive(uniforms) * sizeof(GLint);
}

}  // namespace

std::size_t room_for_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  switch (call) {
    case CallId::GetProgramStringARB:
    case CallId::GetProgramStringNV:
    case CallId::GetNamedProgramStringEXT:
      return std::max(most_state_bytes, assembly_text_bytes(call, words, gl));
    case CallId::GetActiveUniformBlockiv:
    case CallId::GetActiveAtomicCounterBufferiv:
      return std::max(most_state_bytes, uniform_list_bytes(GLuint(words[0]), gl));
    default:
      break;
  }
  return std::string_view(call_name(call)).starts_with("glGetMap") ? most_map_bytes : most_state_bytes;
}

}  // namespace understudy::spu
