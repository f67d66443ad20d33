// SPDX-License-Identifier: Apache-2.0
// The sources that programs were linked from, kept as the calls say them: once shaders are detached and deleted
// no query gives them back, and asking at every link would show in the driver's calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// A program as it was when it was last linked, whether that link succeeded or not: the driver knows.
struct ProgramRecord {
  std::uint64_t link = 0;  ///< different for every link of every program
  std::vector<std::string> vertex_sources;
  std::vector<std::string> fragment_sources;
  bool vertex_shader = false;
  bool other_shader_stages = false;
  bool fragment_source_known = false;
};

/// Shaders and programs share one space of names. Safe from any thread.
class ProgramSources {
 public:
  void shader_created(GLuint shader, GLenum type);
  void source_given(GLuint shader, std::string source);
  /// What is linked is what was last compiled.
  void shader_compiled(GLuint shader);
  /// Compiled from something that is no GLSL text.
  void binary_given(GLuint shader);
  /// The name lives on while the shader is attached.
  void shader_deleted(GLuint shader);

  void program_created(GLuint program);
  void shader_attached(GLuint program, GLuint shader);
  void shader_detached(GLuint program, GLuint shader);
  void program_linked(GLuint program);
  /// By glCreateShaderProgramv: created, attached, linked and detached in one call.
  void program_linked_from(GLuint program, GLenum type, const std::string& source);
  /// By glProgramBinary: its sources are those of the program that `binary` was taken from, in this process.
  void program_loaded(GLuint program, std::span<const std::byte> binary);
  /// glGetProgramBinary gave `binary` of this program.
  void binary_taken(GLuint program, std::span<const std::byte> binary);
  /// Whether `binary` was taken from a program in this process.
  bool knows_binary(std::span<const std::byte> binary) const;
  void program_deleted(GLuint program);

  /// As of the last link in our sight; null when there was none.
  std::shared_ptr<const ProgramRecord> program(GLuint program) const;

 private:
  /// Null: there is none, or it is not known.
  using Source = std::shared_ptr<const std::string>;
  struct Shader {
    GLenum type = 0;
    Source given;
    Source compiled;
    bool deleted = false;
    int attached_to = 0;
  };
  struct Program {
    std::vector<GLuint> shaders;
    std::shared_ptr<const ProgramRecord> linked;
  };

  void detached(GLuint shader);

  mutable std::mutex mutex_;
  std::map<GLuint, Shader> shaders_;
  std::map<GLuint, Program> programs_;
  std::map<std::size_t, std::shared_ptr<const ProgramRecord>> binaries_;  ///< by the hash of their bytes
  std::uint64_t links_ = 0;
};

/// The text that glShaderSource is given; empty when a pointer is missing.
std::string joined(GLsizei count, const GLchar* const* strings, const GLint* lengths);

}  // namespace understudy::spu
