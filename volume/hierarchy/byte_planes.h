// SPDX-License-Identifier: Apache-2.0
// Compresses residuals: the least significant bytes of all of them, then the next ones and so on, by Zstandard
// with its checksum. Most residuals are small, so most planes are nearly all 0.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

/// `effort` is Zstandard's level, 1 to 19.
std::vector<std::byte> packed_planes(std::span<const std::byte> residuals, std::size_t width, int effort);

/// Restores the argument of packed_planes(). Returns false if `packed` is invalid or has another size.
bool unpack_planes(std::span<const std::byte> packed, std::size_t width, std::span<std::byte> residuals);

/// Upper bound of the size of packed planes of this many bytes.
std::size_t most_packed_bytes(std::size_t bytes);

}  // namespace understudy::volume
