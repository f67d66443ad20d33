// A render service before another one: a request that is asked again within a frame is answered with the
// picture that is still there. Some viewers draw all they show twice a frame.
#pragma once

#include <functional>
#include <memory>

#include "compositor/service.h"

namespace understudy::spu {

/// `frames` tells how many frames have ended: a picture is not kept for the next one, in which nodes may be
/// gone.
std::unique_ptr<compositor::RenderService> with_last_picture(std::unique_ptr<compositor::RenderService> service,
                                                             std::function<std::uint64_t()> frames);

}  // namespace understudy::spu
