// SPDX-License-Identifier: Apache-2.0
// What the application's side asks of the render nodes. A request needs nothing but the volume it names: it can
// be saved, sent, replayed and tested alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "volume/blending_operator.h"
#include "volume/classification.h"
#include "volume/depth_image.h"
#include "volume/description.h"
#include "volume/fog.h"
#include "volume/integration_method.h"
#include "volume/light.h"
#include "volume/optimizations.h"
#include "volume/rect.h"
#include "volume/sampling.h"
#include "volume/surface.h"
#include "volume/texture_filter.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// One image of one volume. The same request gives the same image for any number of ranks, bricks and threads,
/// to within 1e-5 (rounding of float, and `termination`).
struct RenderRequest {
  VolumeId volume = 0;
  std::uint64_t version = 0;
  Matrix4 texture_to_clip{};  ///< clip coordinates = texture_to_clip * (t, 1)
  Rect viewport;              ///< as given to glViewport
  Rect window;                ///< the pixels that may be touched: viewport, scissor and framebuffer intersected
  std::array<double, 2> depth_range{0, 1};
  SlicePlanes planes;
  std::optional<RaySteps> steps;  ///< set: the samples lie here, not on planes
  Operator op = Operator::over;
  Filter filter = Filter::linear;
  Box region;  ///< where slices exist: samples outside this box of texture space do not; rays enter it
  std::vector<HalfSpace> clip_planes;
  Classification classification;
  std::optional<SliceSegment>
      slice_segment;       ///< set where the classification is a PreIntegrationTable, and only there
  std::optional<Fog> fog;  ///< under any operator but `min`; not with segments
  // The following are for scalar fields with a transfer function, under `over`, with a linear filter and
  // without fog; those before `light` are for samples on `steps` that end before opaque geometry.
  Method method = Method::post_classified;
  /// Pre-integrated, if not 0: segments end at the faces of bricks with so many blocks of 8^3 cells along each
  /// edge, and where the cells of a node do, as bricks that share no texel but their faces would have it
  /// (Mueller et al. 2006). It makes images depend on the partition, and is here to be compared with.
  std::uint8_t cut_at_bricks = 0;
  /// Adaptive: steps are divided until the error of each, in colour and opacity, is estimated to be no more.
  float tolerance = 1e-3F;
  /// Each is composed where the ray passes it. A sample stands for the step behind it: what of that lies in
  /// front of a surface, and what behind, has a power each of the sample's transparency.
  std::vector<Surface> surfaces;
  std::optional<Light> light;
  /// A ray stops once its transparency falls below this; the error is at most this times the brightest colour.
  float termination = 5e-6F;
  /// A ray ends behind the sample that makes it as opaque as this, at which the application ends its own rays;
  /// 1: none ends so. What would follow is not shown, so parts of a ray do not add up to it: below
  /// `divisible_opacity_limit`, only where every ray is cast whole. Post-classified, under `over`.
  float opacity_limit = 1;
  std::optional<DepthImage> depth;
  /// Nodes that send each other floats may send half floats, each time rounded to 2^-11 of a value.
  bool may_travel_as_halves = false;
  /// Set: the image is of certified bounds. Each of its colour channels holds by how much any channel may
  /// differ from the integral of this medium (error_bound/error_bound.h), and its alpha is the least opacity
  /// that there may be: parts of it compose as colours do. For samples that cover whole rays, with a ghost
  /// layer (ghost_layer_needed()).
  std::optional<MediumFunction> bound_of;
  Optimizations optimizations;

  bool operator==(const RenderRequest&) const = default;
};

/// Whether the samples of a request on steps may cover their whole rays (RaySteps::cover_whole_ray).
inline bool may_cover_whole_rays(const RenderRequest& request) {
  const auto& steps = request.steps;
  return steps && steps->first == 0.5 && !steps->divided && steps->past_depth == 0 && !steps->offsets &&
         !steps->counted_from && !steps->at_least_one && request.op == Operator::over &&
         request.filter == Filter::linear && std::holds_alternative<TransferFunction>(request.classification) &&
         !request.fog && request.method == Method::post_classified && request.surfaces.empty() &&
         !request.light && request.opacity_limit == 1;
}

/// From this opacity limit on, rays may be cast in parts, each of which ends at the limit by itself: together
/// they are at most 1 - limit more opaque than the whole ray.
constexpr float divisible_opacity_limit = 0.97F;

/// Whether an opacity limit keeps rays from being cast in parts.
inline bool needs_whole_rays(const RenderRequest& request) {
  return request.opacity_limit < divisible_opacity_limit;
}

/// Below this transparency nothing more of a ray is asked for: below `termination`, or where it has reached its
/// opacity limit.
inline float least_transparency(const RenderRequest& request) {
  if (request.opacity_limit == 1) return request.termination;
  return std::max(request.termination, std::nextafter(1 - request.opacity_limit, 1.0F));
}

}  // namespace understudy::volume
