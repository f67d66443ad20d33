// SPDX-License-Identifier: Apache-2.0
// Only what shows need travel: the smallest rectangle that holds every pixel a sample has reached.
#pragma once

#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Reduces `image` to that rectangle, in place; an image without any such pixel becomes empty. The image
/// stays the same, because pixels outside an image count as untouched (volume::neutral_value).
void crop_to_content(volume::Image& image, volume::Operator op);

}  // namespace understudy::compositor
