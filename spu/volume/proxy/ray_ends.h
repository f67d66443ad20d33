// SPDX-License-Identifier: Apache-2.0
// Rays that begin and end at planes inside their box, expressed in a request: every pixel's ray begins a number
// of steps later, and ends at the depth of the plane by which it leaves.
#pragma once

#include <vector>

#include "spu/volume/proxy/background_removal.h"
#include "volume/image.h"
#include "volume/texture_space.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Cuts the rays of `request`, whose steps must not be divided. Samples up to `past_planes` steps behind a
/// plane by which a ray leaves still count.
void end_rays_at(const std::vector<volume::HalfSpace>& planes, double past_planes,
                 volume::RenderRequest& request);

/// Gives `alpha` to pixels of alpha 0 whose rays enter the box, between the planes, in front of opaque
/// geometry.
void cover_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                   float alpha, volume::Image& image);

/// Puts `background` behind the pixels of such rays, and behind others that show something.
void fill_behind_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                         const ShaderBackground& background, volume::Image& image);

}  // namespace understudy::spu
