// SPDX-License-Identifier: Apache-2.0
// A render service in front of another one that answers a repeated request with the image that is still there.
// Some viewers draw everything twice per frame; all of them draw frames in which nothing has moved. An image
// that was lossy, because its view moved, is requested again without loss instead.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "compositor/service.h"

namespace understudy::spu {

/// Called for every image that is requested, with the reason why it is cast; empty: it was reused.
using ImageNews = std::function<void(std::string_view why_cast)>;

/// Remembers up to four requests, for viewers that show several volumes, or one volume in several images. An
/// image is reused as long as no volume changes. Without `keeps` every image is cast.
std::unique_ptr<compositor::RenderService> with_last_image(std::unique_ptr<compositor::RenderService> service,
                                                           bool keeps, ImageNews news);

}  // namespace understudy::spu
