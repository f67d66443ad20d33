// SPDX-License-Identifier: Apache-2.0
// What a run of a scenario showed in one frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace adversary {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< rows from below
};

/// A PAM file as `adversary run` writes it. Throws std::runtime_error naming the file.
Image read_image(const std::filesystem::path& path);

}  // namespace adversary
