// SPDX-License-Identifier: Apache-2.0
// Tables of 256 colours that do not lie in a 1-D or 2-D texture.
#pragma once

#include <string>
#include <vector>

#include "tests/adversary/glsl_program.h"
#include "tests/adversary/transfer_function.h"

namespace adversary {

enum class TableKind {
  array_1d,
  array_2d,
  rectangle,
  buffer_texture,
  uniform_block,
  storage_block,
  uniform_array
};

/// Declares `vec4 looked_up(float value)`.
std::string table_declarations(TableKind kind);
/// The shader for another version of GLSL than its first line says.
std::string at_version(int version, std::string shader);

class OddTable {
 public:
  /// Fills it with `colours`, and leaves it where `program`, which it takes into use, finds it: unit 5 or
  /// binding 5.
  OddTable(const Canvas& canvas, TableKind kind, const GlslProgram& program,
           const std::vector<Colour>& colours);

  /// Other colours in the same object.
  void edit(const std::vector<Colour>& colours) const;

 private:
  void create();

  const Gl& gl_;
  TableKind kind_;
  const GlslProgram& program_;
  GLenum target_ = 0;
  GLuint texture_ = 0;
  GLuint buffer_ = 0;
};

}  // namespace adversary
