// SPDX-License-Identifier: Apache-2.0
// Images in DICOM's run-length encoding (part 5, annex G), of one component. Decoded here, because DCMTK 3.6.7
// reads beyond a damaged one.
#pragma once

#include <cstddef>
#include <span>

namespace understudy::volume {

/// Fills `scalars`, of so many bytes each, in native byte order. Throws std::runtime_error that says why it
/// cannot be decoded.
void decode_dicom_rle(std::span<const std::byte> image, std::size_t bytes_of_scalar,
                      std::span<std::byte> scalars);

}  // namespace understudy::volume
