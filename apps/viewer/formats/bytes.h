// SPDX-License-Identifier: Apache-2.0
// Reads a given number of bytes from a plain or gzip-compressed file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace viewer {

/// Whether bytes after the requested ones are an error.
enum class Remainder { forbidden, allowed };

bool has_extension(const std::string& path, std::string_view extension);

/// Reads `count` bytes from `offset` on. Files named *.gz are decompressed; offset and count then refer to the
/// decompressed bytes. Throws Error with the expected and found bytes, and `advice`, if the file is shorter (or
/// longer, and `remainder` is forbidden).
std::vector<std::byte> read_bytes(const std::string& path, std::int64_t offset, std::int64_t count,
                                  Remainder remainder, const std::string& advice);

/// Reverses the bytes of every element of `element_bytes` bytes.
void swap_byte_order(std::span<std::byte> bytes, std::size_t element_bytes);

}  // namespace viewer
