// The volume rendering integral of one pixel of a request: what its samples, taken ever more densely, tend to.
#pragma once

#include <optional>

#include "volume/reference/ray_integral.h"

namespace understudy::volume {

/// The part of a pixel's ray that lies in the request's region, in texture space.
struct PixelRay {
  Vec3 from{};
  Vec3 to{};
  double length = 0;  ///< in steps of `request.steps`
};

/// Empty where the ray misses the region. The request's samples must lie on steps; its clip planes and depth
/// image are not looked at. Throws std::invalid_argument when the matrix is singular or there are no steps.
std::optional<PixelRay> pixel_ray(const RenderRequest& request, int x, int y);

/// Premultiplied colour and opacity of pixel (x, y), where one sample of the request's transfer function stands
/// for a way one step long. `size` is the texture's, in texels. Zero where the ray misses.
std::array<double, 4> pixel_integral(const Field& field, const std::array<int, 3>& size,
                                     const RenderRequest& request, const Medium& medium, int x, int y);

}  // namespace understudy::volume
