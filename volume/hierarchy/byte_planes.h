// SPDX-License-Identifier: Apache-2.0
// Residuals in few bytes: the first bytes of all of them, then the second ones and so on, compressed by
// Zstandard with its checksum. Most residuals are small, so that whole planes are nearly 0.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

/// `effort` is Zstandard's level, 1 to 19.
std::vector<std::byte> packed_planes(std::span<const std::byte> residuals, std::size_t width, int effort);

/// Fills `residuals` with what packed_planes() was given. False where `packed` holds anything else.
bool unpack_planes(std::span<const std::byte> packed, std::size_t width, std::span<std::byte> residuals);

/// No more than that are the packed planes of so many bytes.
std::size_t most_packed_bytes(std::size_t bytes);

}  // namespace understudy::volume
