// SPDX-License-Identifier: Apache-2.0
// Writes composited frames to files: float images that can be compared to the last bit (`understudy compare`).
#pragma once

#include <string>

#include "volume/image.h"

namespace understudy::spu {

/// Writes FOLDER/frame_NNNN.pfm (colour, premultiplied) and FOLDER/frame_NNNN_alpha.pfm over the whole of
/// `viewport`, with `outside` where there is no image. Returns what went wrong, or an empty string.
std::string save_frame(const std::string& folder, std::uint64_t number, const volume::Rect& viewport,
                       const volume::ImageView& image, float outside);

}  // namespace understudy::spu
