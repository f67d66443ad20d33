// SPDX-License-Identifier: Apache-2.0
// The fields of a request and of a volume's description under their names in JSON: listed once, so that what is
// written is also read. `fields(list, value)` calls list(name, member) for every field; the value is const when
// it is written.
#pragma once

#include <array>
#include <concepts>
#include <type_traits>

#include "volume/description.h"
#include "volume/request.h"

namespace understudy::compositor {

template <class T, class Type>
concept Of = std::same_as<std::remove_const_t<T>, Type>;

/// The words for an enumerator, in its order.
template <class Enum>
constexpr std::array<const char*, 0> words{};
template <>
inline constexpr std::array<const char*, 5> words<volume::Operator>{"over", "max", "min", "add", "first_hit"};
template <>
inline constexpr std::array<const char*, 3> words<volume::Filter>{"nearest", "linear", "linear_8_bit"};
template <>
inline constexpr std::array<const char*, 3> words<volume::Wrap>{"edge", "border", "repeat"};
template <>
inline constexpr std::array<const char*, 4> words<volume::TexelType>{"u8", "u16", "f32", "rgba8"};
template <>
inline constexpr std::array<const char*, 3> words<volume::Method>{"post_classified", "pre_integrated",
                                                                  "adaptive"};
template <>
inline constexpr std::array<const char*, 3> words<volume::NormalGuard::Form>{"added", "root_of_squares",
                                                                             "larger"};

template <class List, Of<volume::TexelBox> T>
void fields(List& list, T& box) {
  list("low", box.low);
  list("high", box.high);
}

/// Without id, version and part, which mean something to one process only.
template <class List, Of<volume::VolumeDescription> T>
void fields(List& list, T& volume) {
  list("size", volume.size);
  list("type", volume.type);
  list("wrap", volume.wrap);
  list("border", volume.border);
  list("stored", volume.stored);
  list("ghost_layer", volume.ghost_layer);
}

template <class List, Of<volume::Rect> T>
void fields(List& list, T& rect) {
  list("x", rect.x);
  list("y", rect.y);
  list("width", rect.width);
  list("height", rect.height);
}

template <class List, Of<volume::Box> T>
void fields(List& list, T& box) {
  list("low", box.low);
  list("high", box.high);
}

template <class List, Of<volume::HalfSpace> T>
void fields(List& list, T& plane) {
  list("normal", plane.normal);
  list("offset", plane.offset);
}

template <class List, Of<volume::SlicePlanes> T>
void fields(List& list, T& planes) {
  list("normal", planes.normal);
  list("first", planes.first);
  list("spacing", planes.spacing);
  list("count", planes.count);
}

template <class List, Of<volume::RayOffsets> T>
void fields(List& list, T& offsets) {
  list("width", offsets.width);
  list("height", offsets.height);
  list("steps", offsets.steps);
}

template <class List, Of<volume::RaySteps> T>
void fields(List& list, T& steps) {
  list("metric", steps.metric);
  list("first", steps.first);
  list("divided", steps.divided);
  list("rounding", steps.rounding);
  list("past_depth", steps.past_depth);
  list("offsets", steps.offsets);
  list("counted_from", steps.counted_from);
  list("at_least_one", steps.at_least_one);
  list("cover_whole_ray", steps.cover_whole_ray);
}

template <class List, Of<volume::SliceSegment> T>
void fields(List& list, T& segment) {
  list("planes", segment.planes);
  list("offset", segment.offset);
  list("reach", segment.reach);
}

template <class List, Of<volume::TransferFunction> T>
void fields(List& list, T& function) {
  list("low", function.low);
  list("high", function.high);
  list("entries", function.entries);
}

template <class List, Of<volume::LinearMap> T>
void fields(List& list, T& map) {
  list("matrix", map.matrix);
  list("multiply_by_alpha", map.multiply_by_alpha);
  list("alpha_above", map.alpha_above);
}

template <class List, Of<volume::PreIntegrationTable> T>
void fields(List& list, T& table) {
  list("low", table.low);
  list("high", table.high);
  list("edge", table.edge);
  list("entries", table.entries);
  list("multiply_by_alpha", table.multiply_by_alpha);
}

template <class List, Of<volume::MediumFunction> T>
void fields(List& list, T& medium) {
  list("function", medium.function);
  list("step", medium.step);
}

template <class List, Of<volume::Fog> T>
void fields(List& list, T& fog) {
  list("normal", fog.normal);
  list("offset", fog.offset);
  list("entries", fog.entries);
}

template <class List, Of<volume::Surface> T>
void fields(List& list, T& surface) {
  list("value", surface.value);
  list("colour", surface.colour);
}

template <class List, Of<volume::NormalGuard> T>
void fields(List& list, T& guard) {
  list("slope", guard.slope);
  list("form", guard.form);
}

template <class List, Of<volume::LightResponse> T>
void fields(List& list, T& response) {
  list("diffuse", response.diffuse);
  list("specular", response.specular);
}

template <class List, Of<volume::GradientOpacity> T>
void fields(List& list, T& opacity) {
  list("factors", opacity.factors);
  list("first", opacity.first);
  list("last", opacity.last);
}

template <class List, Of<volume::Light> T>
void fields(List& list, T& light) {
  list("space", light.space);
  list("ray_space", light.ray_space);
  list("direction", light.direction);
  list("ambient", light.ambient);
  list("diffuse", light.diffuse);
  list("specular", light.specular);
  list("shininess", light.shininess);
  list("full_slope", light.full_slope);
  list("guard", light.guard);
  list("two_sided", light.two_sided);
  list("on_samples", light.on_samples);
  list("reach", light.reach);
  list("even", light.even);
  list.unbounded("brightest", light.brightest);
  list("response", light.response);
  list("gradient_opacity", light.gradient_opacity);
}

template <class List, Of<volume::DepthImage> T>
void fields(List& list, T& depth) {
  list("rect", depth.rect);
  list("depth", depth.depth);
  list("or_equal", depth.or_equal);
}

template <class List, Of<volume::Optimizations> T>
void fields(List& list, T& optimizations) {
  list("empty_bricks", optimizations.empty_bricks);
  list("dominated_samples", optimizations.dominated_samples);
  list("footprints", optimizations.footprints);
}

/// Without id and version of the volume.
template <class List, Of<volume::RenderRequest> T>
void fields(List& list, T& request) {
  list("texture_to_clip", request.texture_to_clip);
  list("viewport", request.viewport);
  list("window", request.window);
  list("depth_range", request.depth_range);
  list("planes", request.planes);
  list("steps", request.steps);
  list("operator", request.op);
  list("filter", request.filter);
  list("region", request.region);
  list("clip_planes", request.clip_planes);
  list("classification", request.classification);
  list("slice_segment", request.slice_segment);
  list("fog", request.fog);
  list("method", request.method);
  list("cut_at_bricks", request.cut_at_bricks);
  list("tolerance", request.tolerance);
  list("surfaces", request.surfaces);
  list("light", request.light);
  list("termination", request.termination);
  list("opacity_limit", request.opacity_limit);
  list("depth", request.depth);
  list("may_travel_as_halves", request.may_travel_as_halves);
  list("exact", request.exact);
  list("bound_of", request.bound_of);
  list("optimizations", request.optimizations);
}

}  // namespace understudy::compositor
