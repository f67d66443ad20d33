// SPDX-License-Identifier: Apache-2.0
// Lists the contents of the uniform blocks of the application's program, member by member: a camera that
// changes in every frame and a plane that does not may be in one buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// A scalar, vector or matrix; a long array as a whole.
struct BlockMember {
  std::string name;        ///< "Block.member" of a block with an instance name, otherwise "lights[2].place"
  GLuint block = 0;        ///< index in the program
  std::size_t offset = 0;  ///< bytes in the block
  std::size_t bytes = 0;   ///< with the gaps between its rows
};

/// Returns the members of all active blocks of `program`.
std::vector<BlockMember> block_members(const GlContext& context, GLuint program);

/// Returns the contents of a block of `program`; null if its buffer cannot be read.
std::optional<std::vector<std::byte>> block_contents(const DispatchTable& gl, GLuint program, GLuint block);

/// Appends the number as four values that floats hold exactly.
void append_exactly(std::uint64_t number, std::vector<float>& values);

/// Appends a hash of the bytes as four values: at least one differs if the bytes do.
void append_digest(std::span<const std::byte> bytes, std::vector<float>& values);

}  // namespace understudy::spu
