// SPDX-License-Identifier: Apache-2.0
// Rays that begin and end at planes inside their box, in the words of a request: every pixel's ray begins so
// many steps later, and ends at the depth of the plane that it leaves by.
#pragma once

#include <vector>

#include "spu/volume/proxy/background_removal.h"
#include "volume/image.h"
#include "volume/texture_space.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Cuts the rays of `request`, whose samples lie on steps that are not divided. Behind a plane by which a ray
/// leaves, samples up to `past_planes` steps still count.
void end_rays_at(const std::vector<volume::HalfSpace>& planes, double past_planes,
                 volume::RenderRequest& request);

/// Gives `alpha` to the pixels without it whose rays enter the box, between the planes, before opaque geometry.
void cover_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                   float alpha, volume::Image& image);

/// Puts `background` behind these pixels, and behind others that show something.
void fill_behind_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                         const ShaderBackground& background, volume::Image& image);

}  // namespace understudy::spu
