// SPDX-License-Identifier: Apache-2.0
// The request that the application's side sends to the render nodes. A request depends on nothing but the
// volume that it names: it can be saved, sent, replayed and tested on its own.
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
/// to within 1e-5 (float rounding, and `termination`).
struct RenderRequest {
  VolumeId volume = 0;
  std::uint64_t version = 0;
  Matrix4 texture_to_clip{};  ///< clip coordinates = texture_to_clip * (t, 1)
  Rect viewport;              ///< as given to glViewport
  Rect window;                ///< the pixels that may be drawn: viewport, scissor and framebuffer intersected
  std::array<double, 2> depth_range{0, 1};
  SlicePlanes planes;
  std::optional<RaySteps> steps;  ///< if set, samples lie on these steps instead of on planes
  Operator op = Operator::over;
  Filter filter = Filter::linear;
  Box region;  ///< where slices exist, in texture space: no samples outside this box; rays enter and leave it
  std::vector<HalfSpace> clip_planes;
  Classification classification;
  std::optional<SliceSegment>
      slice_segment;       ///< set if and only if the classification is a PreIntegrationTable
  std::optional<Fog> fog;  ///< under any operator except `min`; not with segments
  // The following apply to scalar fields with a transfer function, under `over`, with a linear filter and
  // without fog; those before `light`, to samples on `steps` that end before opaque geometry.
  Method method = Method::post_classified;
  /// Pre-integrated, if not 0: segments end at the faces of bricks with this many blocks of 8^3 cells along
  /// each edge, and at the boundary of a node's cells, as they would for bricks that share only the texels on
  /// their faces (Mueller et al. 2006). Makes images depend on the partition; provided for comparison only.
  std::uint8_t cut_at_bricks = 0;
  /// Adaptive: steps are divided until the estimated error of each, in colour and opacity, is at most this.
  float tolerance = 1e-3F;
  /// Each is composited where the ray crosses it. A sample represents the step behind it; the parts of that
  /// step in front of and behind a surface each get a power of the sample's transparency.
  std::vector<Surface> surfaces;
  std::optional<Light> light;
  /// A ray ends once its transparency is below this; the error is at most this times the brightest colour.
  float termination = 5e-6F;
  /// A ray ends after the sample with which its opacity reaches this limit, where the application terminates
  /// its own rays; 1: no limit. Samples behind are not shown, so the images of parts of a ray do not composite
  /// to its image: below `divisible_opacity_limit`, every ray must be cast whole. Post-classified, under
  /// `over`.
  float opacity_limit = 1;
  std::optional<DepthImage> depth;
  /// Nodes may exchange half floats instead of floats, each rounded to 2^-11 of its value.
  bool may_travel_as_halves = false;
  /// The image must arrive as it was computed, whatever nodes and connections were told (`--pixels`,
  /// `--quality`): without loss and in floats, but for `may_travel_as_halves`. For images that are compared, or
  /// whose error is bounded.
  bool exact = false;
  /// If set, the image holds certified bounds. Each colour channel is a bound on the difference of any channel
  /// from the integral of this medium (error_bound/error_bound.h), and alpha is a lower bound of the opacity;
  /// parts of such an image composite like colours. For samples that cover whole rays, with a ghost layer
  /// (ghost_layer_needed()).
  std::optional<MediumFunction> bound_of;
  Optimizations optimizations;

  bool operator==(const RenderRequest&) const = default;
};

/// Whether the image must arrive as it was computed. A bound that was rounded would bound nothing.
inline bool must_be_exact(const RenderRequest& request) {
  return request.exact || request.bound_of.has_value();
}

/// Returns the request for the same image, exact.
inline RenderRequest exactly(RenderRequest request) {
  request.exact = true;
  return request;
}

/// Whether the samples of a request on steps can cover their whole rays (RaySteps::cover_whole_ray).
inline bool may_cover_whole_rays(const RenderRequest& request) {
  const auto& steps = request.steps;
  return steps && steps->first == 0.5 && !steps->divided && steps->past_depth == 0 && !steps->offsets &&
         !steps->counted_from && !steps->at_least_one && request.op == Operator::over &&
         request.filter == Filter::linear && std::holds_alternative<TransferFunction>(request.classification) &&
         !request.fog && request.method == Method::post_classified && request.surfaces.empty() &&
         !request.light && request.opacity_limit == 1;
}

/// From this opacity limit on, rays may be cast in parts, each of which ends at the limit by itself: the
/// composite is at most 1 - limit more opaque than the whole ray.
constexpr float divisible_opacity_limit = 0.97F;

/// Whether the opacity limit requires rays to be cast whole.
inline bool needs_whole_rays(const RenderRequest& request) {
  return request.opacity_limit < divisible_opacity_limit;
}

/// The transparency below which a ray terminates: `termination`, or the one at which it has reached its opacity
/// limit.
inline float least_transparency(const RenderRequest& request) {
  if (request.opacity_limit == 1) return request.termination;
  return std::max(request.termination, std::nextafter(1 - request.opacity_limit, 1.0F));
}

}  // namespace understudy::volume
