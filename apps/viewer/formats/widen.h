// SPDX-License-Identifier: Apache-2.0
// Converts voxel types that the viewer does not draw directly (32- and 64-bit integers, doubles) to floats.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

namespace viewer {

/// Converts each T in `voxels` to value * slope + intercept, in float.
template <typename T>
std::vector<std::byte> as_float32(const std::vector<std::byte>& voxels, double slope = 1,
                                  double intercept = 0) {
  const std::size_t count = voxels.size() / sizeof(T);
  std::vector<std::byte> floats(count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, voxels.data() + i * sizeof(T), sizeof(T));
    const auto narrowed = static_cast<float>(static_cast<double>(value) * slope + intercept);
    std::memcpy(floats.data() + i * sizeof(float), &narrowed, sizeof(float));
  }
  return floats;
}

}  // namespace viewer
