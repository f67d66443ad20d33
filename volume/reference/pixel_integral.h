// SPDX-License-Identifier: Apache-2.0
// The volume rendering integral of one pixel of a request: what its samples, taken ever more densely, tend to.
#pragma once

#include <array>
#include <optional>

#include "volume/matrix.h"
#include "volume/reference/ray_integral.h"
#include "volume/texture_space.h"

namespace understudy::volume {

class BrickStore;
struct RenderRequest;

/// The part of a pixel's ray that lies in the request's region, on the right side of its clip planes and before
/// its opaque geometry, in texture space.
struct PixelRay {
  Vec3 from{};
  Vec3 to{};
  double length = 0;  ///< in steps of `request.steps`

  /// `share` of the way.
  Vec3 at(double share) const { return add(from, scale(subtract(to, from), share)); }
};

/// Empty where nothing of the ray does. The request's samples must lie on steps, of which only the unit of
/// length counts. Throws std::invalid_argument when the matrix is singular or there are no steps.
std::optional<PixelRay> pixel_ray(const RenderRequest& request, int x, int y);

/// Premultiplied colour and opacity of pixel (x, y), where one sample of the request's transfer function stands
/// for a way one step long. `size` is the texture's, in texels. Zero where the ray misses.
std::array<double, 4> pixel_integral(const Field& field, const std::array<int, 3>& size,
                                     const RenderRequest& request, const Medium& medium, int x, int y);

/// The part of that which the cells of one rank show: parts of all ranks, composed in visibility order, are the
/// whole. `tolerance` as of ray_integral().
RayIntegral stored_pixel_integral(const BrickStore& store, const RenderRequest& request, const Medium& medium,
                                  int x, int y, double tolerance);

}  // namespace understudy::volume
