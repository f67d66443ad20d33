// SPDX-License-Identifier: Apache-2.0
// Images in JPEG 2000 (ISO 15444-1), as DICOM files hold them. Decoded by OpenJPEG.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

/// The samples of an image of one component and of `size`, x fastest. Throws std::runtime_error that says why
/// it cannot be decoded.
std::vector<std::int32_t> decode_jpeg2000(std::span<const std::byte> image, const std::array<int, 2>& size);

}  // namespace understudy::volume
