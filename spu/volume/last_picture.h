// A render service before another one: a request that was asked before is answered with the picture that is
// still there. Some viewers draw all they show twice a frame; all draw frames in which nothing has moved.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "compositor/service.h"

namespace understudy::spu {

/// Hears of every picture that is asked for: why it is cast, or nothing where there was no need.
using PictureNews = std::function<void(std::string_view why_cast)>;

/// Up to four requests are remembered, for viewers that show several volumes, or one in several pictures. A
/// picture is given again for as long as no volume changes. Without `keeps` every picture is cast.
std::unique_ptr<compositor::RenderService> with_last_picture(std::unique_ptr<compositor::RenderService> service,
                                                             bool keeps, PictureNews news);

}  // namespace understudy::spu
