// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/request_message.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "compositor/service/limits.h"
#include "compositor/service/rect_fields.h"
#include "compositor/transport/wire.h"
#include "volume/cell_lattice.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::compositor {

namespace {

using namespace volume;

void write(Writer& out, std::span<const double> values) {
  for (const double value : values) out.real(value);
}

void read(Reader& in, std::string_view name, std::span<double> values) {
  for (double& value : values) value = in.real(name);
}

template <class T>
void write_run(Writer& out, const std::vector<T>& values) {
  out.run(std::as_bytes(std::span(values)));
}

/// In place of a classification's index: the place of a pre-integration table that was sent before follows.
constexpr int kept_tables = int(std::variant_size_v<Classification>);

void write(Writer& out, const PreIntegrationTable& pairs) {
  out.real(pairs.low);
  out.real(pairs.high);
  out.integer(pairs.edge);
  write_run(out, pairs.entries);
  out.integer(pairs.multiply_by_alpha);
}

void write(Writer& out, const TransferFunction& table) {
  out.real(table.low);
  out.real(table.high);
  write_run(out, table.entries);
}

void write(Writer& out, const Classification& classification, std::optional<int> table_at) {
  if (table_at && std::holds_alternative<PreIntegrationTable>(classification)) {
    out.integer(kept_tables);
    out.integer(*table_at);
    return;
  }
  out.integer(std::int64_t(classification.index()));
  if (const auto* table = std::get_if<TransferFunction>(&classification)) {
    write(out, *table);
  } else if (const auto* pairs = std::get_if<PreIntegrationTable>(&classification)) {
    write(out, *pairs);
  } else {
    const auto& map = std::get<LinearMap>(classification);
    for (const float value : map.matrix) out.real(value);
    out.integer(map.multiply_by_alpha);
    out.real(map.alpha_above);
  }
}

PreIntegrationTable read_pairs(Reader& in) {
  PreIntegrationTable pairs;
  pairs.low = in.real32("classification.low");
  pairs.high = in.real32("classification.high");
  pairs.edge = in.small("classification.edge", 2, max_pre_integration_edge);
  const auto entries = std::size_t(pairs.edge) * std::size_t(pairs.edge);
  pairs.entries = in.values<Rgba>("classification.entries", entries);
  if (pairs.entries.size() != entries) in.fail("classification.entries", "do not fill the square of pairs");
  pairs.multiply_by_alpha = in.flag("classification.multiply_by_alpha");
  return pairs;
}

TransferFunction read_transfer_function(Reader& in) {
  TransferFunction table;
  table.low = in.real32("classification.low");
  table.high = in.real32("classification.high");
  table.entries = in.values<Rgba>("classification.entries", limits::max_table_entries);
  if (table.entries.size() < 2) in.fail("classification.entries", "holds fewer than two entries");
  return table;
}

Classification read_classification(Reader& in, std::span<const PreIntegrationTable> kept) {
  const auto kind = in.integer("classification", 0, kept_tables);
  if (kind == kept_tables) {
    const auto place =
        std::size_t(in.small("classification.place", 0, limits::max_kept_pre_integration_tables - 1));
    if (place >= kept.size() || kept[place].edge == 0)
      in.fail("classification.place", "holds no pre-integration table: send it first");
    return kept[place];
  }
  if (kind == 2) return read_pairs(in);
  if (kind == 0) {
    return read_transfer_function(in);
  }
  LinearMap map;
  for (float& value : map.matrix) value = in.real32("classification.matrix");
  map.multiply_by_alpha = in.flag("classification.multiply_by_alpha");
  map.alpha_above = in.real32("classification.alpha_above");
  return map;
}

void write(Writer& out, const std::optional<RaySteps>& steps) {
  out.integer(steps.has_value());
  if (!steps) return;
  write(out, steps->metric);
  out.real(steps->first);
  out.integer(steps->divided);
  out.real(steps->rounding);
  out.real(steps->past_depth);
  out.integer(steps->counted_from.has_value());
  if (steps->counted_from) out.real(*steps->counted_from);
  out.integer(steps->at_least_one);
  out.integer(steps->cover_whole_ray);
  out.integer(steps->offsets.has_value());
  if (!steps->offsets) return;
  out.integer(steps->offsets->width);
  out.integer(steps->offsets->height);
  write_run(out, steps->offsets->steps);
}

std::optional<RaySteps> read_steps(Reader& in) {
  if (!in.flag("steps")) return std::nullopt;
  RaySteps steps;
  read(in, "steps.metric", steps.metric);
  steps.first = in.real("steps.first");
  steps.divided = in.flag("steps.divided");
  steps.rounding = in.real("steps.rounding");
  steps.past_depth = in.real("steps.past_depth");
  if (in.flag("steps.has_counted_from")) steps.counted_from = in.real("steps.counted_from");
  steps.at_least_one = in.flag("steps.at_least_one");
  steps.cover_whole_ray = in.flag("steps.cover_whole_ray");
  if (!in.flag("steps.offsets")) return steps;
  RayOffsets& offsets = steps.offsets.emplace();
  constexpr int most = limits::max_ray_offsets;
  offsets.width = in.small("steps.offsets.width", 1, most);
  offsets.height = in.small("steps.offsets.height", 1, most);
  offsets.steps = in.values<float>("steps.offsets", limits::max_ray_offsets);
  if (std::uint64_t(offsets.width) * std::uint64_t(offsets.height) != offsets.steps.size())
    in.fail("steps.offsets", "is not a whole rectangle");
  return steps;
}

void write(Writer& out, const std::optional<SliceSegment>& slice_segment) {
  out.integer(slice_segment.has_value());
  if (!slice_segment) return;
  out.real(slice_segment->planes);
  write(out, slice_segment->offset);
  write(out, slice_segment->reach);
}

std::optional<SliceSegment> read_slice_segment(Reader& in) {
  if (!in.flag("slice_segment")) return std::nullopt;
  SliceSegment slice_segment;
  slice_segment.planes = in.real("slice_segment.planes");
  read(in, "slice_segment.offset", slice_segment.offset);
  read(in, "slice_segment.reach", slice_segment.reach);
  return slice_segment;
}

void write(Writer& out, const std::optional<Fog>& fog) {
  out.integer(fog.has_value());
  if (!fog) return;
  write(out, fog->normal);
  out.real(fog->offset);
  write_run(out, fog->entries);
}

std::optional<Fog> read_fog(Reader& in) {
  if (!in.flag("fog")) return std::nullopt;
  Fog fog;
  read(in, "fog.normal", fog.normal);
  fog.offset = in.real("fog.offset");
  fog.entries = in.values<Rgba>("fog.entries", limits::max_table_entries);
  if (fog.entries.size() < 2) in.fail("fog.entries", "holds fewer than two entries");
  return fog;
}

void write_shares(Writer& out, std::span<const float> values) {
  for (const float value : values) out.real(value);
}

void read_shares(Reader& in, std::string_view name, std::span<float> values) {
  for (float& value : values) value = in.real32(name);
}

void write(Writer& out, const std::vector<Surface>& surfaces) {
  out.integer(std::int64_t(surfaces.size()));
  for (const Surface& surface : surfaces) {
    out.real(surface.value);
    write_shares(out, surface.colour);
  }
}

std::vector<Surface> read_surfaces(Reader& in) {
  std::vector<Surface> surfaces(std::size_t(in.integer("surfaces", 0, std::int64_t(max_surfaces))));
  for (Surface& surface : surfaces) {
    surface.value = in.real("surfaces.value");
    read_shares(in, "surfaces.colour", surface.colour);
  }
  return surfaces;
}

void write(Writer& out, const std::optional<Light>& light) {
  out.integer(light.has_value());
  if (!light) return;
  write(out, light->space);
  out.integer(light->ray_space.has_value());
  if (light->ray_space) write(out, *light->ray_space);
  write(out, light->direction);
  for (const auto& colour : {light->ambient, light->diffuse, light->specular}) write_shares(out, colour);
  out.real(light->shininess);
  out.real(light->full_slope);
  out.real(light->guard.slope);
  out.integer(std::int64_t(light->guard.form));
  out.integer(light->two_sided);
  out.integer(light->on_samples);
  write(out, light->reach);
  write_shares(out, light->even);
  out.real(light->brightest);
  out.integer(std::int64_t(light->response.size()));
  for (const LightResponse& entry : light->response) {
    out.real(entry.diffuse);
    out.real(entry.specular);
  }
  out.integer(std::int64_t(light->gradient_opacity.factors.size()));
  for (const float factor : light->gradient_opacity.factors) out.real(factor);
  out.real(light->gradient_opacity.first);
  out.real(light->gradient_opacity.last);
}

std::optional<Light> read_light(Reader& in) {
  if (!in.flag("light")) return std::nullopt;
  Light light;
  read(in, "light.space", light.space);
  if (in.flag("light.ray_space")) read(in, "light.ray_space", light.ray_space.emplace());
  read(in, "light.direction", light.direction);
  read_shares(in, "light.ambient", light.ambient);
  read_shares(in, "light.diffuse", light.diffuse);
  read_shares(in, "light.specular", light.specular);
  light.shininess = in.real32("light.shininess");
  light.full_slope = in.real32("light.full_slope");
  light.guard.slope = in.real("light.guard.slope");
  light.guard.form = NormalGuard::Form(in.small("light.guard.form", 0, int(NormalGuard::Form::larger)));
  light.two_sided = in.flag("light.two_sided");
  light.on_samples = in.flag("light.on_samples");
  read(in, "light.reach", light.reach);
  read_shares(in, "light.even", light.even);
  light.brightest = in.real32("light.brightest");
  light.response.resize(std::size_t(in.integer("light.response", 0, std::int64_t(max_light_responses))));
  for (LightResponse& entry : light.response) {
    entry.diffuse = in.real32("light.response.diffuse");
    entry.specular = in.real32("light.response.specular");
  }
  GradientOpacity& opacity = light.gradient_opacity;
  opacity.factors.resize(
      std::size_t(in.integer("light.gradient_opacity", 0, std::int64_t(max_gradient_opacities))));
  for (float& factor : opacity.factors) factor = in.real32("light.gradient_opacity.factors");
  opacity.first = in.real("light.gradient_opacity.first");
  opacity.last = in.real("light.gradient_opacity.last");
  return light;
}

void write(Writer& out, const std::optional<DepthImage>& depth) {
  out.integer(depth.has_value());
  if (!depth) return;
  write(out, depth->rect);
  write_run(out, depth->depth);
  out.integer(depth->or_equal);
}

std::optional<DepthImage> read_depth(Reader& in) {
  if (!in.flag("depth")) return std::nullopt;
  DepthImage depth;
  depth.rect = read_pixels(in, "depth.rect");
  depth.depth = in.values<float>("depth.depth", depth.rect.pixels());
  if (depth.depth.size() != depth.rect.pixels()) in.fail("depth.depth", "does not fill depth.rect");
  depth.or_equal = in.flag("depth.or_equal");
  return depth;
}

}  // namespace

std::vector<std::byte> encode(const KeptPreIntegrationTable& kept) {
  Writer out;
  out.integer(kept.place);
  write(out, kept.table);
  return out.bytes();
}

KeptPreIntegrationTable decode_pre_integration_table(std::span<const std::byte> payload) {
  Reader in("pre-integration table", payload);
  KeptPreIntegrationTable kept;
  kept.place = in.small("place", 0, limits::max_kept_pre_integration_tables - 1);
  kept.table = read_pairs(in);
  in.end();
  return kept;
}

std::vector<std::byte> encode(const RenderRequest& request, std::optional<int> table_at) {
  Writer out;
  out.integer(must_be_exact(request));
  out.integer(std::int64_t(request.volume));
  out.integer(std::int64_t(request.version));
  write(out, request.texture_to_clip);
  write(out, request.viewport);
  write(out, request.window);
  write(out, request.depth_range);
  write(out, request.planes.normal);
  out.real(request.planes.first);
  out.real(request.planes.spacing);
  out.integer(request.planes.count);
  write(out, request.steps);
  out.integer(std::int64_t(request.op));
  out.integer(std::int64_t(request.filter));
  write(out, request.region.low);
  write(out, request.region.high);
  out.integer(std::int64_t(request.clip_planes.size()));
  for (const HalfSpace& plane : request.clip_planes) {
    write(out, plane.normal);
    out.real(plane.offset);
  }
  write(out, request.classification, table_at);
  write(out, request.slice_segment);
  write(out, request.fog);
  out.integer(std::int64_t(request.method));
  out.integer(request.cut_at_bricks);
  out.real(request.tolerance);
  write(out, request.surfaces);
  write(out, request.light);
  out.real(request.termination);
  out.real(request.opacity_limit);
  write(out, request.depth);
  out.integer(request.may_travel_as_halves);
  out.integer(request.bound_of.has_value());
  if (request.bound_of) {
    write(out, request.bound_of->function);
    out.real(request.bound_of->step);
  }
  for (const bool left_out : {request.optimizations.empty_bricks, request.optimizations.dominated_samples,
                              request.optimizations.footprints})
    out.integer(left_out);
  return out.bytes();
}

bool asks_for_exact_image(std::span<const std::byte> payload) {
  return Reader("render request", payload).flag("exact");
}

RenderRequest decode_request(std::span<const std::byte> payload, std::span<const PreIntegrationTable> kept) {
  Reader in("render request", payload);
  RenderRequest request;
  request.exact = in.flag("exact");
  request.volume = in.word("volume");
  request.version = in.word("version");
  read(in, "texture_to_clip", request.texture_to_clip);
  request.viewport = read_rect(in, "viewport");
  request.window = read_pixels(in, "window");
  read(in, "depth_range", request.depth_range);
  read(in, "planes.normal", request.planes.normal);
  request.planes.first = in.real("planes.first");
  request.planes.spacing = in.real("planes.spacing");
  request.planes.count = in.small("planes.count", 0, max_planes);
  request.steps = read_steps(in);
  request.op = in.enumerator("op", Operator::first_hit);
  request.filter = in.enumerator("filter", Filter::linear_8_bit);
  read(in, "region.low", request.region.low);
  read(in, "region.high", request.region.high);
  request.clip_planes.resize(std::size_t(in.integer("clip_planes", 0, limits::max_clip_planes)));
  for (HalfSpace& plane : request.clip_planes) {
    read(in, "clip_planes.normal", plane.normal);
    plane.offset = in.real("clip_planes.offset");
  }
  request.classification = read_classification(in, kept);
  request.slice_segment = read_slice_segment(in);
  request.fog = read_fog(in);
  request.method = in.enumerator("method", Method::adaptive);
  request.cut_at_bricks = std::uint8_t(in.integer("cut_at_bricks", 0, 255));
  request.tolerance = in.real32("tolerance");
  request.surfaces = read_surfaces(in);
  request.light = read_light(in);
  request.termination = in.real32("termination");
  request.opacity_limit = in.real32("opacity limit");
  request.depth = read_depth(in);
  request.may_travel_as_halves = in.flag("may_travel_as_halves");
  if (in.flag("bound_of")) {
    MediumFunction& medium = request.bound_of.emplace();
    medium.function = read_transfer_function(in);
    medium.step = in.real("bound_of.step");
  }
  for (bool* left_out : {&request.optimizations.empty_bricks, &request.optimizations.dominated_samples,
                         &request.optimizations.footprints})
    *left_out = in.flag("optimizations");
  in.end();
  return request;
}

}  // namespace understudy::compositor
