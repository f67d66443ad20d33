// SPDX-License-Identifier: Apache-2.0
// Implements validate() of ray_caster.h.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "volume/cell_lattice.h"
#include "volume/matrix.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

constexpr std::size_t max_clip_planes = 64;
constexpr int max_window = 65536;

template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw std::invalid_argument(fmt::format(format, std::forward<Args>(args)...));
}

template <typename Range>
bool are_finite(const Range& values) {
  return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
}

bool believable(const Rect& rect) {
  const auto in = [](int v) { return v >= -max_window && v <= max_window; };
  return in(rect.x) && in(rect.y) && in(rect.width) && in(rect.height);
}

/// Whether samples must not lie beyond the texture along `axis`: if it repeats, in texels that only other ranks
/// hold; under a nearest filter, in a border, which kernels do not read because they clamp positions.
bool ends_with_texture(const VolumeDescription& volume, const RenderRequest& request, std::size_t axis) {
  const Wrap wrap = volume.wrap[axis];
  return wrap == Wrap::repeat || (wrap == Wrap::border && request.filter == Filter::nearest);
}

/// Such a texture, in words.
const char* words_for(Wrap wrap) {
  return wrap == Wrap::repeat ? "a repeating texture" : "a texture with a border and a nearest filter";
}

void validate_classification(const VolumeDescription& volume, const Classification& classification) {
  if (const auto* function = std::get_if<TransferFunction>(&classification)) {
    if (volume.type == TexelType::rgba8)
      refuse("a volume of colours needs a linear map, not a transfer function");
    if (function->entries.size() < 2 || function->entries.size() > max_table_entries)
      refuse("the transfer function has {} entries (2 to {} are possible)", function->entries.size(),
             max_table_entries);
    if (!std::isfinite(function->low) || !std::isfinite(function->high) || !(function->low < function->high))
      refuse("the transfer function spans values {} to {}", function->low, function->high);
    for (const Rgba& entry : function->entries)
      if (!are_finite(entry)) refuse("the transfer function holds a value that is not finite");
  } else if (const auto* pairs = std::get_if<PreIntegrationTable>(&classification)) {
    if (volume.type == TexelType::rgba8)
      refuse("a volume of colours needs a linear map, not a pre-integration table");
    if (pairs->edge < 2 || pairs->edge > max_pre_integration_edge ||
        pairs->entries.size() != std::size_t(pairs->edge) * std::size_t(pairs->edge))
      refuse("the pre-integration table has {} entries and an edge of {} (2 to {} are possible)",
             pairs->entries.size(), pairs->edge, max_pre_integration_edge);
    if (!std::isfinite(pairs->low) || !std::isfinite(pairs->high) || !(pairs->low < pairs->high))
      refuse("the pre-integration table spans values {} to {}", pairs->low, pairs->high);
    for (const Rgba& entry : pairs->entries)
      if (!are_finite(entry)) refuse("the pre-integration table holds a value that is not finite");
  } else {
    const LinearMap& map = std::get<LinearMap>(classification);
    if (volume.type != TexelType::rgba8)
      refuse("a scalar field needs a transfer function, not a linear map of colours");
    if (!are_finite(map.matrix) || std::isnan(map.alpha_above))
      refuse("the map of colours holds a value that is not finite");
  }
}

void validate_steps(const RaySteps& steps, const Box& region) {
  if (!are_finite(steps.metric) || !std::isfinite(steps.first) || !std::isfinite(steps.rounding) ||
      !std::isfinite(steps.past_depth) || !std::isfinite(steps.counted_from.value_or(0)))
    refuse("the steps along rays hold a value that is not finite");
  const auto row = [&](std::size_t r) {
    return Vec3{steps.metric[3 * r], steps.metric[3 * r + 1], steps.metric[3 * r + 2]};
  };
  const double volume = std::abs(dot(row(0), cross(row(1), row(2))));
  const bool regular = steps.between_planes()
                           ? length(row(0)) > 0
                           : volume > 1e-9 * length(row(0)) * length(row(1)) * length(row(2));
  if (!regular) refuse("the metric of the steps along rays is singular");
  if (!(steps.first >= 0 && steps.rounding >= 0 && steps.rounding <= 1 && steps.past_depth >= 0 &&
        steps.first <= max_planes && steps.past_depth <= max_planes))
    refuse("rays begin {} steps from their entry, end {} behind opaque geometry, and are rounded by {}",
           steps.first, steps.past_depth, steps.rounding);
  if (const double from = steps.counted_from.value_or(0); !(from >= 0 && from <= max_planes))
    refuse("samples are counted from {} steps behind their rays' entry", from);
  if (const auto& offsets = steps.offsets) {
    const bool rectangle =
        offsets->width > 0 && offsets->height > 0 &&
        offsets->steps.size() / std::size_t(offsets->width) == std::size_t(offsets->height) &&
        offsets->steps.size() % std::size_t(offsets->width) == 0;
    if (!rectangle) refuse("the offsets of the rays' first samples are no rectangle");
    for (const float offset : offsets->steps)
      if (!(steps.first + offset >= 0 && offset <= max_planes))
        refuse("a ray begins {} steps from its entry", steps.first + offset);
  }
  const Vec3 across = subtract(region.high, region.low);
  double most = 0;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t k = 0; k < 3; ++k) most += std::abs(steps.metric[3 * r + k] * across[k]);
  if (!(most <= max_planes)) refuse("rays of {} steps (at most {} are possible)", most, max_planes);
}

/// Checks the requirements of RaySteps::cover_whole_ray.
void validate_whole_rays(const RenderRequest& request) {
  if (!request.steps || !request.steps->cover_whole_ray || may_cover_whole_rays(request)) return;
  refuse(
      "samples that cover whole rays lie in the middle of whole steps, end before opaque geometry, and are "
      "those of a transfer function under over, with a linear filter, without fog, light, surfaces or an "
      "opacity limit");
}

void validate_bound(const VolumeDescription& volume, const RenderRequest& request) {
  if (!request.bound_of) return;
  if (!request.steps || !request.steps->cover_whole_ray)
    refuse("bounds of the error are for samples that cover whole rays");
  if (std::ranges::any_of(volume.wrap, [](Wrap wrap) { return wrap != Wrap::edge; }))
    refuse("bounds of the error are for textures that end with their outermost texels");
  const MediumFunction& medium = *request.bound_of;
  validate_classification(volume, medium.function);
  if (!(medium.step > 0 && std::isfinite(medium.step))) refuse("a medium for a step of {}", medium.step);
  if (const int cells = ghost_layer_needed(volume, request); cells > volume.ghost_layer)
    refuse(
        "bounds of the error look {} cells around samples in a volume that was sent with a ghost layer of {}: "
        "send "
        "it again",
        cells, volume.ghost_layer);
}

/// Samples beyond the region must not lie in texels that only other ranks hold, nor in segments.
void validate_count(const VolumeDescription& volume, const RenderRequest& request) {
  const auto& steps = request.steps;
  if (!steps) return;
  constexpr double most_beyond = 16;
  const double beyond = steps->beyond_end();
  if (!steps->counted_from && beyond == 0) return;
  if (beyond > most_beyond) refuse("samples lie {} steps beyond the end of their ray", beyond);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (beyond > 0 && ends_with_texture(volume, request, axis))
      refuse("samples lie beyond the end of their ray in {}", words_for(volume.wrap[axis]));
  if (!is_all_of_texture(request.region, volume.size))
    refuse("samples that may lie beyond the end of their ray, in a region that is not the whole texture");
  if (!request.clip_planes.empty() || has_segments(request))
    refuse("samples that may lie beyond the end of their ray know neither clip planes nor segments");
}

void validate_slice_segment(const VolumeDescription& volume, const RenderRequest& request) {
  const bool pairs = std::holds_alternative<PreIntegrationTable>(request.classification);
  if (pairs && !request.slice_segment) refuse("a pre-integration table needs segments");
  if (!pairs && request.slice_segment) refuse("segments need a pre-integration table");
  if (!pairs) return;
  if (request.steps) refuse("segments lie on planes, not on steps along rays");
  if (request.fog) refuse("there is no fog with segments");
  const SliceSegment& slice_segment = *request.slice_segment;
  if (!std::isfinite(slice_segment.planes) || !are_finite(slice_segment.offset) ||
      !are_finite(slice_segment.reach))
    refuse("the segments hold a value that is not finite");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = slice_segment.reach[axis] * volume.size[axis];
    if (!(cells >= 0 && cells <= volume.ghost_layer))
      refuse(
          "segments of {} texels along axis {} in a volume that was sent with a ghost layer of {}: send it "
          "again",
          cells, axis, volume.ghost_layer);
    if (ends_with_texture(volume, request, axis) && cells > 0 &&
        (request.region.low[axis] - slice_segment.reach[axis] < 0 ||
         request.region.high[axis] + slice_segment.reach[axis] > 1))
      refuse("segments reach beyond {} along axis {}", words_for(volume.wrap[axis]), axis);
  }
}

void validate_cut(const VolumeDescription& volume, int blocks) {
  if (blocks == 0) return;
  constexpr double most = 65536;
  double bricks = 1;
  for (const int texels : volume.size) bricks *= std::ceil(double(texels) / (blocks * BrickStore::block_cells));
  if (!(bricks <= most))
    refuse("segments are cut at {} bricks of {} cells (at most {} are possible): cut at larger ones", bricks,
           blocks * BrickStore::block_cells, most);
}

void validate_filter(const VolumeDescription& volume, const RenderRequest& request) {
  if (request.filter != Filter::linear_8_bit) return;
  if (volume.type != TexelType::u8) refuse("the linear filter of 8 bits is for one byte a texel");
  if (request.slice_segment) refuse("segments have no linear filter of 8 bits");
  if (std::find(volume.wrap.begin(), volume.wrap.end(), Wrap::border) != volume.wrap.end())
    refuse("the linear filter of 8 bits knows no border");
}

void validate_fog(const Fog& fog, Operator op) {
  if (op == Operator::min) refuse("there is no fog under the operator min");
  if (fog.entries.size() < 2 || fog.entries.size() > max_table_entries)
    refuse("the fog has {} entries (2 to {} are possible)", fog.entries.size(), max_table_entries);
  for (const Rgba& entry : fog.entries)
    if (!are_finite(entry)) refuse("the fog holds a value that is not finite");
  if (!are_finite(fog.normal) || !std::isfinite(fog.offset))
    refuse("the direction of the fog holds a value that is not finite");
}

void validate_camera(const RenderRequest& request) {
  if (!are_finite(request.texture_to_clip))
    refuse("the matrix from texture to clip space holds a value that is not finite");
  if (!inverse(request.texture_to_clip)) refuse("the matrix from texture to clip space is singular");
  if (!believable(request.viewport) || !believable(request.window) || request.viewport.empty())
    refuse("viewport of {} x {} pixels at ({}, {})", request.viewport.width, request.viewport.height,
           request.viewport.x, request.viewport.y);
  if (!are_finite(request.depth_range)) refuse("the depth range holds a value that is not finite");
}

void validate_planes(const SlicePlanes& planes) {
  if (!are_finite(planes.normal) || !std::isfinite(planes.first) || !std::isfinite(planes.spacing))
    refuse("the slice planes hold a value that is not finite");
  if (!(length(planes.normal) > 0)) refuse("the slice planes have no direction");
}

/// Checks where samples lie. With steps, the planes are ignored except for their number.
void validate_places(const RenderRequest& request) {
  if (request.steps)
    validate_steps(*request.steps, request.region);
  else
    validate_planes(request.planes);
  const SlicePlanes& planes = request.planes;
  if (planes.count < 0 || planes.count > max_planes)
    refuse("{} slice planes (0 to {} are possible)", planes.count, max_planes);
}

/// Checks the visible part of the volume: the region of the slices, and the clip planes.
void validate_region(const VolumeDescription& volume, const RenderRequest& request) {
  if (!are_finite(request.region.low) || !are_finite(request.region.high))
    refuse("the region of the slices holds a value that is not finite");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr double slack = 1e-6;
    if (ends_with_texture(volume, request, axis) &&
        (request.region.low[axis] < -slack || request.region.high[axis] > 1 + slack))
      refuse("slices reach beyond {} along axis {} ({} to {})", words_for(volume.wrap[axis]), axis,
             request.region.low[axis], request.region.high[axis]);
  }
  if (request.clip_planes.size() > max_clip_planes)
    refuse("{} clip planes (at most {} are possible)", request.clip_planes.size(), max_clip_planes);
  for (const HalfSpace& plane : request.clip_planes)
    if (!are_finite(plane.normal) || !std::isfinite(plane.offset))
      refuse("a clip plane holds a value that is not finite");
}

/// Checks where rays end.
void validate_ends(const RenderRequest& request) {
  if (!(request.termination >= 0 && request.termination < 1))
    refuse("termination threshold {} is outside [0, 1)", request.termination);
  if (!(request.opacity_limit > 0 && request.opacity_limit <= 1))
    refuse("opacity limit {} is outside (0, 1]", request.opacity_limit);
  if (request.opacity_limit < 1 &&
      (request.op != Operator::over || request.method != Method::post_classified || !request.surfaces.empty()))
    refuse("an opacity limit is for post-classified samples under over, without surfaces");
  if (request.depth &&
      (!believable(request.depth->rect) || request.depth->depth.size() != request.depth->rect.pixels()))
    refuse("the depth image holds {} values for {} x {} pixels", request.depth->depth.size(),
           request.depth->rect.width, request.depth->rect.height);
}

}  // namespace

void validate(const VolumeDescription& volume, const RenderRequest& request) {
  validate_camera(request);
  validate_places(request);
  validate_region(volume, request);
  validate_count(volume, request);
  validate_whole_rays(request);
  validate_bound(volume, request);
  validate_cut(volume, request.cut_at_bricks);
  validate_ends(request);
  validate_classification(volume, request.classification);
  validate_slice_segment(volume, request);
  if (request.fog) validate_fog(*request.fog, request.op);
  validate_filter(volume, request);
  validate_segments(volume, request);
}

}  // namespace understudy::volume
