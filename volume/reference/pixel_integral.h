// SPDX-License-Identifier: Apache-2.0
// The volume rendering integral of one pixel of a request: the limit for ever denser samples.
#pragma once

#include <array>
#include <optional>

#include "volume/matrix.h"
#include "volume/reference/ray_integral.h"
#include "volume/texture_space.h"

namespace understudy::volume {

class BrickStore;
struct RenderRequest;

/// The part of a pixel's ray that lies in the request's region, on the visible side of its clip planes and in
/// front of its opaque geometry, in texture space.
struct PixelRay {
  Vec3 from{};
  Vec3 to{};
  double length = 0;  ///< in steps of `request.steps`

  /// The point at fraction `share` of the ray.
  Vec3 at(double share) const { return add(from, scale(subtract(to, from), share)); }
};

/// Empty if no part of the ray is visible. The request's samples must lie on steps, of which only the unit of
/// length matters. Throws std::invalid_argument when the matrix is singular or there are no steps.
std::optional<PixelRay> pixel_ray(const RenderRequest& request, int x, int y);

/// Premultiplied colour and opacity of pixel (x, y), where one sample of the request's transfer function
/// represents a layer one step long. `size` is the texture's, in texels. Zero if the ray misses.
std::array<double, 4> pixel_integral(const Field& field, const std::array<int, 3>& size,
                                     const RenderRequest& request, const Medium& medium, int x, int y);

/// The part of it in the cells of one rank: the parts of all ranks, composited in visibility order, give the
/// whole. `tolerance` as for ray_integral().
RayIntegral stored_pixel_integral(const BrickStore& store, const RenderRequest& request, const Medium& medium,
                                  int x, int y, double tolerance);

}  // namespace understudy::volume
