// SPDX-License-Identifier: Apache-2.0
// The sources that programs were linked from, recorded from the calls: once shaders are detached and deleted,
// no query returns them, and querying them at every link would add calls to the driver.
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

/// A program as of its last link, whether or not that succeeded, which only the driver knows.
struct ProgramRecord {
  std::uint64_t link = 0;  ///< unique for every link of every program
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
  /// The source at the last compilation is what will be linked.
  void shader_compiled(GLuint shader);
  /// The shader was compiled from something other than GLSL text.
  void binary_given(GLuint shader);
  /// The name stays valid while the shader is attached.
  void shader_deleted(GLuint shader);

  void program_created(GLuint program);
  void shader_attached(GLuint program, GLuint shader);
  void shader_detached(GLuint program, GLuint shader);
  void program_linked(GLuint program);
  /// glCreateShaderProgramv: created, attached, linked and detached in one call.
  void program_linked_from(GLuint program, GLenum type, const std::string& source);
  /// glProgramBinary: the sources are those of the program in this process that `binary` was read from.
  void program_loaded(GLuint program, std::span<const std::byte> binary);
  /// glGetProgramBinary returned `binary` for this program.
  void binary_taken(GLuint program, std::span<const std::byte> binary);
  /// Whether `binary` was read from a program in this process.
  bool knows_binary(std::span<const std::byte> binary) const;
  void program_deleted(GLuint program);

  /// The program as of the last link that was recorded; null if there was none.
  std::shared_ptr<const ProgramRecord> program(GLuint program) const;

 private:
  /// Null: no source, or an unknown one.
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

/// Joins the strings given to glShaderSource; empty if a pointer is missing.
std::string joined(GLsizei count, const GLchar* const* strings, const GLint* lengths);

}  // namespace understudy::spu
