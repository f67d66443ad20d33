// SPDX-License-Identifier: Apache-2.0
// Decodes DICOM's run-length encoding (part 5, annex G) for images of one component. Implemented here, because
// DCMTK 3.6.7 reads beyond the end of damaged images.
#pragma once

#include <cstddef>
#include <span>

namespace understudy::volume {

/// Fills `scalars`, of `bytes_of_scalar` bytes each, in native byte order. Throws std::runtime_error with the
/// reason if decoding fails.
void decode_dicom_rle(std::span<const std::byte> image, std::size_t bytes_of_scalar,
                      std::span<std::byte> scalars);

}  // namespace understudy::volume
