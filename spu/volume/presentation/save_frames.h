// SPDX-License-Identifier: Apache-2.0
// Writes composited frames to files: float images that can be compared to the last bit (`understudy compare`).
#pragma once

#include <cstdint>
#include <string>

#include "volume/image.h"

namespace understudy::spu {

/// An image as the contents of two PFM files.
struct FloatMaps {
  std::string colour;  ///< premultiplied
  std::string alpha;
};

/// Returns the image over the whole of `viewport`, with `outside` where there is none.
FloatMaps float_maps(const volume::Rect& viewport, const volume::ImageView& image, float outside);

/// Writes them to FOLDER/frame_NNNN.pfm and FOLDER/frame_NNNN_alpha.pfm. Returns what went wrong, or an empty
/// string.
std::string save_frame(const std::string& folder, std::uint64_t number, const volume::Rect& viewport,
                       const volume::ImageView& image, float outside);

}  // namespace understudy::spu
