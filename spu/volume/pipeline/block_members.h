// SPDX-License-Identifier: Apache-2.0
// What lies in the uniform blocks of the application's program, member by member: a camera that moves in every
// frame and a plane that stays lie in one buffer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// A number, vector or matrix; of a long array, all of them.
struct BlockMember {
  std::string name;        ///< "Block.member" of a block with an instance name, "lights[2].place" of others
  GLuint block = 0;        ///< its index in the program
  std::size_t offset = 0;  ///< bytes in the block
  std::size_t bytes = 0;   ///< with the gaps of its rows, but for the last one
};

/// Of all active blocks of `program`.
std::vector<BlockMember> block_members(const GlContext& context, GLuint program);

/// What a block of `program` holds; nothing where its buffer cannot be read.
std::optional<std::vector<std::byte>> block_contents(const DispatchTable& gl, GLuint program, GLuint block);

/// Four numbers, of which one differs where bytes do.
void append_digest(std::span<const std::byte> bytes, std::vector<float>& values);

}  // namespace understudy::spu
