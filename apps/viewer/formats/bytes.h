// SPDX-License-Identifier: Apache-2.0
// Reads a stated number of bytes from a plain or gzip-compressed file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace viewer {

/// Whether bytes after the wanted ones are an error.
enum class Remainder { forbidden, allowed };

bool has_extension(const std::string& path, std::string_view extension);

/// `count` bytes from `offset` on; files named *.gz are decompressed (offset and count then mean decompressed
/// bytes). Throws Error naming the expected and found bytes, and `advice`, when the file is shorter (or longer
/// and forbidden).
std::vector<std::byte> read_bytes(const std::string& path, std::int64_t offset, std::int64_t count,
                                  Remainder remainder, const std::string& advice);

/// Reverses the bytes of every element of `element_bytes`.
void swap_byte_order(std::span<std::byte> bytes, std::size_t element_bytes);

}  // namespace viewer
