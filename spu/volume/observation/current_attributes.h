// SPDX-License-Identifier: Apache-2.0
// The current vertex attributes: the values that a vertex takes unless an array or a call of its own supplies
// others (OpenGL 4.6 compatibility, 10.2). Calls between draws set them, and so do draws of single vertices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

struct MemoryArray;

/// Attributes that calls have set.
struct AttributeSet {
  /// Those that have a current value. In compatibility profiles attribute 0 is the vertex, which has none.
  std::uint32_t generic = ~std::uint32_t(1);
  /// Colours, normal, texture coordinates, fog coordinate and edge flag.
  bool fixed_function = false;
  /// Generic attributes, one bit each, by the type of their values.
  std::uint32_t floats = 0;
  std::uint32_t integers = 0;
  std::uint32_t doubles = 0;

  /// Adds what a call of kind `vertex` sets; `words` are its arguments in the form of AsWords.
  void add(CallId call, const std::uint64_t* words);
  /// Adds what the elements of these arrays set if they are drawn one by one.
  void add(std::span<const MemoryArray> arrays);
  /// Adds what a display list of vertices may set.
  void add_list();
  void add(const AttributeSet& others);
  bool empty() const { return !fixed_function && (floats | integers | doubles) == 0; }
};

/// The values of attributes at one moment.
class CurrentAttributes {
 public:
  /// Reads the attributes in `set` from the current context.
  CurrentAttributes(const DispatchTable& gl, const AttributeSet& set);
  void make_current(const DispatchTable& gl) const;

 private:
  using Four = std::array<GLfloat, 4>;
  struct FixedFunction {
    Four colour;
    Four secondary_colour;
    Four normal;
    /// OpenGL's minimum number of fixed-function units with coordinates.
    std::array<Four, 8> coordinates;
    GLfloat fog_coordinate;
    GLboolean edge_flag;
  };
  template <class T>
  struct Generic {
    GLuint index = 0;
    std::array<T, 4> value{};
  };

  std::optional<FixedFunction> fixed_function_;
  std::vector<Generic<GLfloat>> floats_;
  std::vector<Generic<GLint>> integers_;
  std::vector<Generic<GLdouble>> doubles_;
};

}  // namespace understudy::spu
