// SPDX-License-Identifier: Apache-2.0
// Crops an image to the smallest rectangle that holds every pixel a sample has reached: only that is sent.
#pragma once

#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Crops `image` in place; without any such pixel it becomes empty. What the image shows is unchanged, because
/// pixels outside an image count as untouched (volume::neutral_value).
void crop_to_content(volume::Image& image, volume::Operator op);

}  // namespace understudy::compositor
