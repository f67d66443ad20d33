// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/capture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "spu/volume/context/context.h"
#include "spu/volume/geometry/transform_feedback.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {
namespace {

float component_of(const StageInput& input, const float* captured) {
  if (!input.integer) return *captured;
  std::int32_t whole;
  std::memcpy(&whole, captured, sizeof whole);
  return float(whole);
}

/// All inputs at the vertex that begins at `vertex`; zeros for those that are not written.
InputValues values_at(const float* vertex, const ProgramStages& stages,
                      const std::vector<std::size_t>& offsets) {
  InputValues values(stages.inputs.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const StageInput& input = stages.inputs[i];
    if (!input.written) continue;
    for (std::size_t c = 0; c < std::size_t(input.components); ++c)
      values[i][c] = component_of(input, vertex + offsets[i] + c);
  }
  return values;
}

/// Triangles that join tiles or fill a buffer draw nothing, and their vertices may be arbitrary.
void drop_degenerate_triangles(std::vector<float>& data, std::size_t stride) {
  const auto position = [&](std::size_t vertex) {
    return std::array{data[vertex * stride], data[vertex * stride + 1], data[vertex * stride + 2],
                      data[vertex * stride + 3]};
  };
  std::size_t kept = 0;
  for (std::size_t v = 0; v + 2 < data.size() / stride; v += 3) {
    const auto a = position(v);
    const auto b = position(v + 1);
    const auto c = position(v + 2);
    if (a == b || b == c || c == a) continue;
    std::copy_n(data.begin() + std::ptrdiff_t(v * stride), 3 * stride, data.begin() + std::ptrdiff_t(kept));
    kept += 3 * stride;
  }
  data.resize(kept);
}

/// Checks the first `axes` axes.
bool within_texture(std::span<const ObservedVertex> vertices, std::size_t axes) {
  constexpr double slack = 1e-4;
  return std::all_of(vertices.begin(), vertices.end(), [&](const ObservedVertex& vertex) {
    return std::all_of(vertex.texture.begin(), vertex.texture.begin() + std::ptrdiff_t(axes),
                       [](double t) { return t >= -slack && t <= 1 + slack; });
  });
}

/// Bounds of all inputs but the coordinate, whose bounds are zero.
InputRange range_of(const Capture& capture, const ProgramStages& stages) {
  InputRange range{capture.first, capture.first};
  for (std::size_t i = 0; i < stages.inputs.size(); ++i) {
    const StageInput& input = stages.inputs[i];
    if (input.name == capture.coordinate) range.low[i] = range.high[i] = {};
    if (input.name == capture.coordinate || !input.written) continue;
    for (std::size_t c = 0; c < std::size_t(input.components); ++c) {
      for (std::size_t at = capture.offsets[i] + c; at < capture.data.size(); at += capture.stride) {
        const float value = component_of(input, &capture.data[at]);
        // A NaN becomes both bounds and stays; no range covers it.
        if (std::isnan(value)) range.low[i][c] = range.high[i][c] = value;
        if (value < range.low[i][c]) range.low[i][c] = value;
        if (value > range.high[i][c]) range.high[i][c] = value;
      }
    }
  }
  return range;
}

/// Returns the vertices of `run` after the vertex stage, three per triangle; empty if nothing was drawn, or too
/// much.
std::vector<float> captured_data(const GlContext& context, const Run& run, const ProgramStages& stages,
                                 std::size_t stride) {
  TransformFeedback feedback(context, stages.observer);
  const std::string missing = copy_uniforms(context, run.pipeline().program, stages.observer);
  if (!missing.empty()) throw Refusal{not_copied(missing)};
  context.gl->UseProgram(stages.observer);
  return feedback.triangles(run, stride);
}

/// Returns the positions; texture coordinates are chosen later.
ObservedPolygons triangles_of(const Capture& capture) {
  ObservedPolygons polygons;
  const std::size_t vertices = capture.data.size() / capture.stride;
  polygons.vertices.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t c = 0; c < 4; ++c) polygons.vertices[v].clip[c] = capture.data[v * capture.stride + c];
    if (v % 3 == 2) polygons.first.push_back(v + 1);
  }
  return polygons;
}

/// Gives the triangles of `capture` their texture coordinates: `axes` floats at `offset` of each vertex. The
/// third coordinate of a stack is the index of the slice, one of `slices`.
void take_coordinates(Capture& capture, std::size_t offset, std::size_t axes, std::size_t slices) {
  auto& vertices = capture.polygons.vertices;
  const std::size_t of_slice = vertices.size() / std::max<std::size_t>(slices, 1);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (std::size_t c = 0; c < axes; ++c)
      vertices[v].texture[c] = capture.data[v * capture.stride + offset + c];
    if (axes == 3) continue;
    const std::size_t slice = v / of_slice;
    vertices[v].texture[2] = double(slice);
  }
}

/// Chooses the input that addresses the texture: of several that are affine maps of the position (a position in
/// the world, a second coordinate), the one that stays within the texture. With a `coordinate` no other is
/// tried.
void choose_coordinate(Capture& capture, const ProgramStages& stages, const std::string& coordinate,
                       std::size_t axes, std::size_t slices) {
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < stages.inputs.size(); ++i) {
    const StageInput& input = stages.inputs[i];
    if (input.integer || !input.written || std::size_t(input.components) < axes) continue;
    if (!coordinate.empty() && input.name != coordinate) continue;
    take_coordinates(capture, capture.offsets[i], axes, slices);
    const auto fit = fit_camera(capture.polygons.vertices);
    if (!fit || fit->residual > max_fit_residual) continue;
    const bool inside = within_texture(capture.polygons.vertices, axes);
    if (!capture.fit || inside) {
      capture.coordinate = input.name;
      capture.fit = fit;
      chosen = capture.offsets[i];
    }
    if (inside) break;
  }
  if (capture.fit) take_coordinates(capture, chosen, axes, slices);
}

}  // namespace

bool InputRange::covers(const InputRange& inner) const {
  if (inner.low.size() != low.size()) return false;
  for (std::size_t i = 0; i < low.size(); ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      if (!(inner.low[i][c] >= low[i][c] && inner.high[i][c] <= high[i][c])) return false;
    }
  }
  return true;
}

Capture capture_vertices(const GlContext& context, const Run& run, const ProgramStages& stages,
                         const std::string& coordinate) {
  // Transform feedback of triangles raises an error if other primitives are drawn, and the application would
  // see it.
  if (!run.only_polygons) throw Refusal{"points or lines are drawn among the slices"};
  Capture capture;
  capture.stride = 4;
  for (const StageInput& input : stages.inputs) {
    capture.offsets.push_back(capture.stride);
    if (input.written) capture.stride += std::size_t(input.components);
  }
  for (const UnprobedInput& input : stages.unprobed) {
    capture.unprobed_offsets.push_back(capture.stride);
    capture.stride += input.floats();
  }
  capture.data = captured_data(context, run, stages, capture.stride);
  drop_degenerate_triangles(capture.data, capture.stride);
  if (capture.data.empty()) return capture;
  const float* const last = capture.data.data() + (capture.data.size() - capture.stride);
  capture.first = values_at(capture.data.data(), stages, capture.offsets);
  capture.last = values_at(last, stages, capture.offsets);
  capture.polygons = triangles_of(capture);

  const bool stack = run.pipeline().stack;
  const std::size_t slices = stack ? run.slices().size() : 1;
  // Each slice of a stack must be drawn with the same number of vertices; otherwise no camera fits.
  if (capture.polygons.vertices.size() % (3 * slices) != 0) return capture;
  choose_coordinate(capture, stages, coordinate, stack ? 2 : 3, slices);
  if (capture.fit) capture.range = range_of(capture, stages);
  return capture;
}

}  // namespace understudy::spu
