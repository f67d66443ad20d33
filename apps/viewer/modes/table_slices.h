// SPDX-License-Identifier: Apache-2.0
// Shared by the modes with a colour table in GLSL 1.20: a program that looks texels up in a table, and one
// triangle fan per slice from client vertex arrays.
#pragma once

#include <string>

#include "apps/viewer/modes/gl_objects.h"
#include "apps/viewer/modes/mode.h"

namespace viewer {

class TableSlices {
 public:
  /// Sets the uniforms `volume` (unit 0) and `table` (unit 1). Null sources: the plain look-up. `name`
  /// identifies the program in errors.
  explicit TableSlices(const std::string& name, const char* vertex_source = nullptr,
                       const char* fragment_source = nullptr);

  GLuint program() const { return program_.name(); }
  const Texture& table() const { return table_; }
  /// Draws the stack through a 3-D texture.
  void draw(const SliceStack& stack, const Matrices& matrices, const Texture& volume) const;

 private:
  Texture table_;
  Program program_;
};

}  // namespace viewer
