// SPDX-License-Identifier: Apache-2.0
// Decodes JPEG 2000 images (ISO 15444-1) in DICOM files, with OpenJPEG.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

/// The samples of a single-component image of `size`, x fastest. Throws std::runtime_error with the reason if
/// decoding fails.
std::vector<std::int32_t> decode_jpeg2000(std::span<const std::byte> image, const std::array<int, 2>& size);

}  // namespace understudy::volume
