// SPDX-License-Identifier: Apache-2.0
// A render service before another one: a request that was asked before is answered with the image that is
// still there. Some viewers draw all they show twice a frame; all draw frames in which nothing has moved.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "compositor/service.h"

namespace understudy::spu {

/// Hears of every image that is asked for: why it is cast, or nothing where there was no need.
using ImageNews = std::function<void(std::string_view why_cast)>;

/// Up to four requests are remembered, for viewers that show several volumes, or one in several images. A
/// image is given again for as long as no volume changes. Without `keeps` every image is cast.
std::unique_ptr<compositor::RenderService> with_last_image(std::unique_ptr<compositor::RenderService> service,
                                                           bool keeps, ImageNews news);

}  // namespace understudy::spu
