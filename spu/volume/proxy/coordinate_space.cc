// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/coordinate_space.h"

#include <algorithm>

#include "spu/volume/context/context.h"
#include "spu/volume/proxy/cut_box.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

/// What the polygons of a draw enclose.
std::optional<CutBox> body_of(const Capture& capture) {
  if (const auto box = box_of(capture.polygons, capture.fit->texture_to_clip)) return CutBox{*box, {}};
  return cut_box_of(capture.polygons);
}

/// With `input` for the coordinate; in `captured`, unless the run was captured so before.
const Capture& capture_by(const MarchContext& measured, const std::string& input, Capture& captured) {
  if (measured.seen != nullptr && measured.seen->coordinate == input) return *measured.seen;
  captured = capture_vertices(measured.context, measured.run, measured.stages, input);
  return captured;
}

bool is_cut(const CutBox& body) {
  return volume::length(body.cut.normal) > 0;
}

/// What an input may be whose values fill `box`.
std::vector<CoordinateSpace> spaces_of(const std::string& input, const volume::Box& box,
                                       const std::array<int, 3>& size) {
  constexpr double fewest_texels = 2.02;  // a box of the world may be as small
  bool unit = true;
  bool texels = true;
  bool whole = true;
  CoordinateSpace in_texels{input};
  CoordinateSpace of_box{.input = input, .of_whole_box = true};
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = size[k];
    const double slack = 1.01 / n;
    const double edge = box.high[k] - box.low[k];
    unit = unit && box.low[k] >= -slack && box.high[k] <= 1 + slack;
    whole = whole && edge >= 1 - 2 * slack;
    texels = texels && box.low[k] >= -1.01 && box.high[k] <= n + 1.01 && edge > fewest_texels;
    in_texels.scale[k] = 1 / n;
    of_box.scale[k] = 1 / edge;
    of_box.offset[k] = -box.low[k] / edge;
  }
  std::vector<CoordinateSpace> spaces;
  if (unit) {
    spaces.push_back({input});
  } else if (texels) {
    spaces.push_back(in_texels);
    for (std::size_t k = 0; k < 3; ++k) in_texels.offset[k] = 0.5 / size[k];
    spaces.push_back(in_texels);
  }
  if (!unit || !whole) spaces.push_back(of_box);
  return spaces;
}

}  // namespace

bool draws_box(const GlContext& context, const Run& run, const ProgramStages& stages, const Capture& seen) {
  constexpr std::size_t most_triangles = 4096;  // of a box
  if (seen.polygons.count() > most_triangles) return false;
  if (seen.fit && body_of(seen)) return true;
  return std::any_of(stages.inputs.begin(), stages.inputs.end(), [&](const StageInput& input) {
    if (input.integer || input.components < 3 || input.name == seen.coordinate) return false;
    const Capture capture = capture_vertices(context, run, stages, input.name);
    return capture.fit && body_of(capture);
  });
}

std::vector<CoordinateSpace> coordinate_spaces(const MarchContext& measured) {
  std::vector<CoordinateSpace> spaces;
  Capture captured;
  for (const StageInput& input : measured.stages.inputs) {
    if (input.integer || input.components < 3) continue;
    const Capture& capture = capture_by(measured, input.name, captured);
    if (!capture.fit) continue;
    const auto body = body_of(capture);
    if (!body) continue;
    std::vector<CoordinateSpace> of_input = spaces_of(input.name, body->box, measured.texture.size);
    // What is left of a box before the near plane is no whole one.
    if (is_cut(*body)) std::erase_if(of_input, &CoordinateSpace::of_whole_box);
    if (of_input.empty()) continue;
    const CoordinateSpace& likeliest = of_input.front();
    if (!likeliest.of_whole_box && likeliest.scale == volume::Vec3{1, 1, 1}) return of_input;
    if (spaces.empty()) spaces = std::move(of_input);
  }
  return spaces;
}

std::optional<ProxyBox> proxy_box(const MarchContext& measured, const CoordinateSpace& space) {
  Capture captured;
  const Capture& capture = capture_by(measured, space.input, captured);
  if (!capture.fit || capture.fit->residual > max_fit_residual) return std::nullopt;
  const auto body = body_of(capture);
  if (!body || !wholly_in_view(capture.polygons)) return std::nullopt;
  if (!is_cut(*body) && !wholly_in_view(capture.fit->texture_to_clip, body->box)) return std::nullopt;
  ProxyBox proxy{body->box, *capture.fit, {}};
  volume::HalfSpace cut{{}, body->cut.offset};
  volume::Matrix4 to_input = volume::identity();
  for (std::size_t k = 0; k < 3; ++k) {
    proxy.region.low[k] = space.scale[k] * body->box.low[k] + space.offset[k];
    proxy.region.high[k] = space.scale[k] * body->box.high[k] + space.offset[k];
    cut.normal[k] = body->cut.normal[k] / space.scale[k];
    cut.offset -= cut.normal[k] * space.offset[k];
    to_input[5 * k] = 1 / space.scale[k];
    to_input[4 * k + 3] = -space.offset[k] / space.scale[k];
  }
  if (is_cut(*body)) proxy.cuts.push_back(cut);
  proxy.camera.texture_to_clip = volume::multiply(capture.fit->texture_to_clip, to_input);
  return proxy;
}

}  // namespace understudy::spu
