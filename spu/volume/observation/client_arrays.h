// SPDX-License-Identifier: Apache-2.0
// Draws from the application's own memory, captured at the time of the call.
//
// The memory may change before the run is drawn (one buffer that is refilled for every slice is common). The
// draw is therefore kept as OpenGL defines it: glBegin, one glArrayElement per index, glEnd, with each array's
// value as an immediate call.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dispatch/table.h"
#include "spu/stream/record.h"

namespace understudy::spu {

struct GlContext;

/// One enabled vertex array in the application's memory.
struct MemoryArray {
  enum class Role { vertex, normal, colour, texture_coordinate, generic } role = Role::vertex;
  int index = 0;  ///< texture unit or generic attribute
  int components = 4;
  GLenum type = GL_FLOAT;
  bool normalised = false;
  std::size_t stride = 0;  ///< bytes
  const std::byte* first = nullptr;
};

struct ArraySources {
  bool client_memory = false;  ///< at least one array is read from the application's memory
  std::vector<MemoryArray> arrays;
};

/// Determines where the next array draw would read its vertices. Returns a reason if the mixture is not
/// supported.
std::optional<std::string> read_array_sources(const GlContext& context, ArraySources& sources);

/// Returns whether an index may restart a primitive instead of identifying a vertex.
bool restarts_primitives(const GlContext& context);

/// Appends the array elements `indices` as one glBegin/glEnd.
void append_elements(Records& calls, const ArraySources& sources, GLenum mode,
                     const std::vector<std::uint32_t>& indices);

}  // namespace understudy::spu
