// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/coordinate_space.h"

#include <algorithm>

#include "spu/volume/context/context.h"
#include "spu/volume/proxy/cut_box.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

/// Returns the box, possibly cut, that the polygons of a draw enclose.
std::optional<CutBox> body_of(const Capture& capture) {
  if (const auto box = box_of(capture.polygons, capture.fit->texture_to_clip)) return CutBox{*box, {}};
  return cut_box_of(capture.polygons);
}

/// Returns the capture of the run with `input` as the coordinate: the existing one, or a new one in `captured`.
const Capture& capture_by(const MarchContext& measured, const std::string& input, Capture& captured) {
  if (measured.seen != nullptr && measured.seen->coordinate == input) return *measured.seen;
  captured = capture_vertices(measured.context, measured.run, measured.stages, input);
  return captured;
}

bool is_cut(const CutBox& body) {
  return volume::length(body.cut.normal) > 0;
}

/// Returns the texture coordinates that an input whose values fill `box` may be.
std::vector<CoordinateSpace> spaces_of(const std::string& input, const volume::Box& box,
                                       const std::array<int, 3>& size) {
  constexpr double fewest_texels = 2.02;  // a box in world units may be as small
  bool unit = true;
  bool texels = true;
  bool whole = true;
  CoordinateSpace in_texels{.input = input};
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
    spaces.push_back({.input = input});
  } else if (texels) {
    spaces.push_back(in_texels);
    for (std::size_t k = 0; k < 3; ++k) in_texels.offset[k] = 0.5 / size[k];
    spaces.push_back(in_texels);
  }
  if (!unit || !whole) spaces.push_back(of_box);
  return spaces;
}

/// Whether the eye is at (0, 0, 0), as it is in an input that holds the vector from the eye.
bool begins_at_eye(const volume::Matrix4& input_to_clip, const volume::Box& box) {
  constexpr double nearly = 1e-3;  // of the box
  double edge = 0;
  for (std::size_t k = 0; k < 3; ++k) edge = std::max(edge, box.high[k] - box.low[k]);
  // At the eye, clip x, y and w are 0.
  return std::ranges::all_of(std::array<std::size_t, 3>{0, 4, 12}, [&](std::size_t row) {
    const volume::Vec3 slope{input_to_clip[row], input_to_clip[row + 1], input_to_clip[row + 2]};
    return std::abs(input_to_clip[row + 3]) <= nearly * edge * volume::length(slope);
  });
}

std::optional<volume::Vec3> constant_input(const MarchContext& measured, const Capture& capture,
                                           std::size_t input) {
  const StageInput& described = measured.stages.inputs[input];
  if (described.integer || !described.written || described.components < 3) return std::nullopt;
  volume::Vec3 value{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float first = capture.value(0, input, k);
    for (std::size_t v = 1; v * capture.stride < capture.data.size(); ++v) {
      if (capture.value(v, input, k) != first) return std::nullopt;
    }
    value[k] = double(first);
  }
  return value;
}

std::optional<volume::Vec3> uniform_vector(const MarchContext& measured, const std::string& name) {
  const DispatchTable& gl = *measured.context.gl;
  const GLuint program = measured.run.pipeline().program;
  const GLint location = gl.GetUniformLocation(program, name.c_str());
  if (location < 0) return std::nullopt;
  std::array<float, 4> value{};
  gl.GetUniformfv(program, location, value.data());
  return volume::Vec3{double(value[0]), double(value[1]), double(value[2])};
}

/// Returns the value of `name` in this draw; null if it has none or several.
std::optional<volume::Vec3> origin_of(const MarchContext& measured, const Capture& capture,
                                      const std::string& name) {
  if (name.empty()) return volume::Vec3{};
  const auto input = std::ranges::find(measured.stages.inputs, name, &StageInput::name);
  if (input != measured.stages.inputs.end())
    return constant_input(measured, capture, std::size_t(input - measured.stages.inputs.begin()));
  return uniform_vector(measured, name);
}

/// Whether the type can hold a position; a fourth component may be a homogeneous one or something else.
bool is_vector(GLenum type) {
  return type == GL_FLOAT_VEC3 || type == GL_FLOAT_VEC4;
}

/// Names of vectors that may be the eye's position.
std::vector<std::string> possible_origins(const ProgramStages& stages, const std::string& input) {
  std::vector<std::string> names;
  for (const StageInput& other : stages.inputs) {
    if (is_vector(other.type) && other.name != input) names.push_back(other.name);
  }
  for (const StageUniform& uniform : stages.uniforms) {
    if (is_vector(uniform.type)) names.push_back(uniform.name);
  }
  return names;
}

/// Texture coordinates that are the vector from the eye in `input` plus the eye's position.
std::vector<CoordinateSpace> spaces_from_eye(const MarchContext& measured, const Capture& capture,
                                             const std::string& input, const volume::Box& box) {
  if (!begins_at_eye(capture.fit->texture_to_clip, box)) return {};
  for (const std::string& name : possible_origins(measured.stages, input)) {
    const auto origin = origin_of(measured, capture, name);
    if (!origin) continue;
    std::vector<CoordinateSpace> spaces = spaces_of(
        input, {volume::add(box.low, *origin), volume::add(box.high, *origin)}, measured.texture.size);
    if (spaces.front().of_whole_box) continue;
    for (CoordinateSpace& space : spaces) space.origin = name;
    return spaces;
  }
  return {};
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
    std::vector<CoordinateSpace> of_input = spaces_from_eye(measured, capture, input.name, body->box);
    if (of_input.empty()) of_input = spaces_of(input.name, body->box, measured.texture.size);
    // What the near plane leaves of a box is not the whole box.
    if (is_cut(*body)) std::erase_if(of_input, &CoordinateSpace::of_whole_box);
    if (of_input.empty()) continue;
    const CoordinateSpace& likeliest = of_input.front();
    if (likeliest.origin.empty() && !likeliest.of_whole_box && likeliest.scale == volume::Vec3{1, 1, 1})
      return of_input;
    if (spaces.empty()) spaces = std::move(of_input);
  }
  return spaces;
}

std::optional<ProxyBox> proxy_box(const MarchContext& measured, const CoordinateSpace& space) {
  Capture captured;
  const Capture& capture = capture_by(measured, space.input, captured);
  if (!capture.fit || capture.fit->residual > max_fit_residual) return std::nullopt;
  const auto origin = origin_of(measured, capture, space.origin);
  const auto body = body_of(capture);
  if (!origin || !body || !wholly_in_view(capture.polygons)) return std::nullopt;
  if (!is_cut(*body) && !wholly_in_view(capture.fit->texture_to_clip, body->box)) return std::nullopt;
  ProxyBox proxy{body->box, *capture.fit, {}};
  volume::HalfSpace cut{{}, body->cut.offset};
  volume::Matrix4 to_input = volume::identity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double offset = space.scale[k] * (*origin)[k] + space.offset[k];
    proxy.region.low[k] = space.scale[k] * body->box.low[k] + offset;
    proxy.region.high[k] = space.scale[k] * body->box.high[k] + offset;
    cut.normal[k] = body->cut.normal[k] / space.scale[k];
    cut.offset -= cut.normal[k] * offset;
    to_input[5 * k] = 1 / space.scale[k];
    to_input[4 * k + 3] = -offset / space.scale[k];
  }
  if (is_cut(*body)) proxy.cuts.push_back(cut);
  proxy.camera.texture_to_clip = volume::multiply(capture.fit->texture_to_clip, to_input);
  return proxy;
}

}  // namespace understudy::spu
