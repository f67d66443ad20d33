// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/segment_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

#include "volume/footprint.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

void demand(bool holds, const char* otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

template <typename Range>
bool all_finite(const Range& values) {
  return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
}

void validate_response(const Light& light) {
  const std::vector<LightResponse>& response = light.response;
  if (response.empty()) return;
  demand(response.size() >= 2 && response.size() <= max_light_responses,
         "a light's response has at least 2 and at most 4096 entries");
  demand(light.direction == std::array<double, 3>{}, "a light with a response shines from the eye");
  for (const LightResponse& entry : response)
    demand(std::isfinite(entry.diffuse) && std::isfinite(entry.specular),
           "the light's response holds a value that is not finite");
}

void validate_gradient_opacity(const GradientOpacity& opacity) {
  const std::vector<float>& factors = opacity.factors;
  if (factors.empty()) return;
  demand(factors.size() >= 2 && factors.size() <= max_gradient_opacities,
         "a gradient opacity has at least 2 and at most 16384 factors");
  demand(std::ranges::all_of(factors, [](float factor) { return factor >= 0 && factor <= 1; }),
         "a gradient opacity holds a factor outside of [0, 1]");
  demand(std::isfinite(opacity.first) && std::isfinite(opacity.last) && opacity.first < opacity.last,
         "a gradient opacity's slopes must be finite, and the last larger than the first");
}

bool not_negative(const std::array<float, 3>& colour) {
  return std::all_of(colour.begin(), colour.end(), [](float v) { return std::isfinite(v) && v >= 0; });
}

Vec3 row_of(const std::array<double, 9>& m, std::size_t row) {
  return {m[3 * row], m[3 * row + 1], m[3 * row + 2]};
}

Vec3 transformed(const std::array<double, 9>& m, const Vec3& v) {
  return {dot(row_of(m, 0), v), dot(row_of(m, 1), v), dot(row_of(m, 2), v)};
}

bool regular(const std::array<double, 9>& m) {
  if (!all_finite(m)) return false;
  const Vec3 a = row_of(m, 0), b = row_of(m, 1), c = row_of(m, 2);
  return std::abs(dot(a, cross(b, c))) > 1e-9 * length(a) * length(b) * length(c);
}

/// Inverts a regular matrix.
std::array<double, 9> inverse_of(const std::array<double, 9>& m) {
  const Vec3 a = row_of(m, 0), b = row_of(m, 1), c = row_of(m, 2);
  const std::array<Vec3, 3> columns{cross(b, c), cross(c, a), cross(a, b)};
  const double determinant = dot(a, columns[0]);
  std::array<double, 9> inverse{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      inverse[3 * row + column] = columns[column][row] / determinant;
  return inverse;
}

/// Upper bound, in cells along each axis, of the distance that a ray of the image covers from plane to plane;
/// infinite where rays are parallel to the planes. Ray directions are linear in the pixel's position, so the
/// ratio of their components along an axis and across the planes is largest in a corner.
std::array<double, 3> reach_between_planes(const VolumeDescription& volume, const RenderRequest& request) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 3> endless{infinity, infinity, infinity};
  const auto clip_to_texture = inverse(request.texture_to_clip);
  if (!clip_to_texture) return endless;
  const Matrix4& m = *clip_to_texture;
  const Vec3 into{m[2], m[6], m[10]};
  const Vec3 normal = row_of(request.steps->metric, 0);
  const Rect seen = footprint(request, request.region);
  std::array<double, 3> reach{};
  bool forwards = false, backwards = false;
  for (const int x : {seen.x, seen.x + seen.width})
    for (const int y : {seen.y, seen.y + seen.height}) {
      const Vec4 p = transform(m, {2.0 * (x - request.viewport.x) / request.viewport.width - 1,
                                   2.0 * (y - request.viewport.y) / request.viewport.height - 1, 0, 1});
      const Vec3 way = subtract(scale(into, p[3]), scale({p[0], p[1], p[2]}, m[14]));
      const double across = dot(normal, way);
      forwards = forwards || !(across < 0);
      backwards = backwards || !(across > 0);
      for (std::size_t axis = 0; axis < 3; ++axis)
        reach[axis] = std::max(reach[axis], std::abs(way[axis] / across) * volume.size[axis]);
    }
  return forwards && backwards ? endless : reach;
}

}  // namespace

bool has_segments(const RenderRequest& request) {
  return request.method != Method::post_classified || !request.surfaces.empty();
}

bool walks_segments(const RenderRequest& request) {
  return has_segments(request) || request.light.has_value();
}

int ghost_layer_needed(const VolumeDescription& volume, const RenderRequest& request) {
  if (request.bound_of && request.steps) {
    // A sample may represent 1.5 steps, around which second differences are taken.
    const std::array<double, 3> reach = step_reach(volume, request);
    return int(std::min(std::ceil(1.5 * *std::ranges::max_element(reach)) + 2, 1e9));
  }
  if (!walks_segments(request)) return 0;
  double reach = 0;
  if (has_segments(request) && request.steps)
    for (const double along : step_reach(volume, request)) reach = std::max(reach, along);
  constexpr double rounding = 1e-6;  // of the reach, in cells
  double gradient = 0;
  if (request.light) gradient = *std::ranges::max_element(request.light->reach);
  return int(std::min(std::ceil(reach + gradient - rounding), 1e9));
}

std::array<double, 3> step_reach(const VolumeDescription& volume, const RenderRequest& request) {
  if (request.steps->between_planes()) return reach_between_planes(volume, request);
  const std::array<double, 9> inverse = inverse_of(request.steps->metric);
  // A ray of L steps divided into floor(L + rounding) parts has parts of less than 2 - rounding steps.
  const double part = request.steps->divided ? 2 - request.steps->rounding : 1;
  std::array<double, 3> reach{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach[axis] = part * length(row_of(inverse, axis)) * volume.size[axis];
  return reach;
}

void validate_segments(const VolumeDescription& volume, const RenderRequest& request) {
  if (!walks_segments(request)) return;
  demand(volume.type != TexelType::rgba8,
         "surfaces, light and pre-integration are for scalar fields, not for colours: ask for colours alone");
  demand(
      std::holds_alternative<TransferFunction>(request.classification),
      "surfaces, light and pre-integration need a transfer function (of clear entries, if surfaces alone are "
      "to be seen)");
  demand(request.op == Operator::over, "surfaces, light and pre-integration need the operator over");
  const bool lit_samples = !has_segments(request) && request.light->on_samples;
  demand(request.filter == Filter::linear || (request.filter == Filter::linear_8_bit && lit_samples),
         "surfaces, light and pre-integration need a linear filter, which has 8 bits for lit samples alone");
  demand(!request.fog, "there is no fog with surfaces, light or pre-integration");
  if (has_segments(request)) {
    demand(request.steps.has_value(),
           "surfaces and pre-integration need steps along rays: give steps instead of planes");
    demand(request.steps->past_depth == 0,
           "surfaces and pre-integration end before opaque geometry: ask for no samples behind it");
  }
  if (request.method == Method::adaptive) {
    demand(request.surfaces.empty() && !request.light,
           "adaptive steps know neither surfaces nor light: ask for samples or pre-integration");
    demand(request.tolerance > 0, "adaptive steps need a tolerance above 0");
  }
  if (request.surfaces.size() > max_surfaces)
    throw std::invalid_argument(
        fmt::format("{} surfaces (at most {} are possible)", request.surfaces.size(), max_surfaces));
  for (const Surface& surface : request.surfaces) {
    demand(std::isfinite(surface.value) && all_finite(surface.colour),
           "a surface holds a value that is not finite");
    demand(surface.colour[3] >= 0 && surface.colour[3] <= 1, "a surface's opacity is outside [0, 1]");
  }
  if (const auto& light = request.light) {
    demand(regular(light->space) && regular(light->ray_space.value_or(light->space)),
           "the matrix from texture space to the light's space is singular");
    demand(all_finite(light->direction), "the direction to the light holds a value that is not finite");
    demand(not_negative(light->ambient) && not_negative(light->diffuse) && not_negative(light->specular) &&
               std::isfinite(light->shininess) && light->shininess >= 0 && std::isfinite(light->full_slope) &&
               light->full_slope >= 0,
           "the light's colours, shininess and full slope must be finite and not negative");
    demand(std::isfinite(light->guard.slope) && light->guard.slope >= 0,
           "what guards normals must be finite and not negative");
    demand(std::ranges::all_of(light->reach, [](double cells) { return cells >= 0.125 && cells <= 16; }),
           "a light's gradients reach 1/8 to 16 texels");
    demand(not_negative(light->even), "what points without a gradient keep must be finite and not negative");
    demand(light->brightest > 0, "lit points show less than nothing");
    validate_response(*light);
    validate_gradient_opacity(light->gradient_opacity);
    demand(light->gradient_opacity.factors.empty() || lit_samples,
           "gradient opacity is for samples, without surfaces and pre-integration");
  }
  if (const int cells = ghost_layer_needed(volume, request); cells > volume.ghost_layer)
    throw std::invalid_argument(fmt::format(
        "segments and gradients reach {} cells in a volume that was sent with a ghost layer of {}: send it "
        "again with a ghost layer of {}",
        cells, volume.ghost_layer, cells));
}

PreparedLight::PreparedLight(const Light& light, const VolumeDescription& volume)
    : model(light),
      full_slope(float(light.full_slope * largest_texel(volume.type))),
      guard{light.guard.slope * largest_texel(volume.type), light.guard.form},
      gradient_opacity{light.gradient_opacity.factors,
                       light.gradient_opacity.first * largest_texel(volume.type),
                       light.gradient_opacity.last * largest_texel(volume.type)},
      inverse_(inverse_of(light.space)) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size_[axis] = volume.size[axis];
    reach[axis] = float(light.reach[axis]);
  }
  const double largest =
      std::max({std::abs(light.direction[0]), std::abs(light.direction[1]), std::abs(light.direction[2])});
  if (largest > 0) {
    direction_ = scale(light.direction, 1 / largest);
    direction_ = scale(direction_, 1 / volume::length(direction_));
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      metric[3 * i + k] = float(size_[i] * size_[k] * dot(row_of(inverse_, i), row_of(inverse_, k)));
}

Vec3 PreparedLight::to_eye(const std::array<float, 3>& step) const {
  const Vec3 way{-double(step[0]) / size_[0], -double(step[1]) / size_[1], -double(step[2]) / size_[2]};
  const Vec3 eye = transformed(model.ray_space.value_or(model.space), way);
  const double distance = volume::length(eye);
  return distance > 0 ? scale(eye, 1 / distance) : Vec3{};
}

// Gradients are covectors: the dot product of a gradient's image (under the inverse transpose) with a direction
// equals that of the gradient with the direction's image under the inverse.
std::array<float, 3> PreparedLight::over_gradients(const Vec3& direction) const {
  const Vec3 v = transformed(inverse_, direction);
  return {float(v[0] * size_[0]), float(v[1] * size_[1]), float(v[2] * size_[2])};
}

std::array<float, 3> PreparedLight::light(const std::array<float, 3>& step) const {
  return over_gradients(volume::length(direction_) > 0 ? direction_ : to_eye(step));
}

std::array<float, 3> PreparedLight::half(const std::array<float, 3>& step) const {
  const Vec3 eye = to_eye(step);
  const Vec3 sum = volume::length(direction_) > 0 ? add(direction_, eye) : eye;
  const double distance = volume::length(sum);
  return over_gradients(distance > 1e-9 ? scale(sum, 1 / distance) : Vec3{});
}

LightResponse PreparedLight::response_at(float cosine) const {
  const float last = float(model.response.size() - 1);
  const float place = std::clamp((cosine + 1) / 2 * last, 0.0F, last);
  const std::size_t entry = std::min(std::size_t(place), model.response.size() - 2);
  const LightResponse &below = model.response[entry], &above = model.response[entry + 1];
  const float share = place - float(entry);
  return {below.diffuse + share * (above.diffuse - below.diffuse),
          below.specular + share * (above.specular - below.specular)};
}

SegmentScene::SegmentScene(const VolumeDescription& volume, const RenderRequest& request)
    : pre_integrated(request.method == Method::pre_integrated),
      lit_samples(request.light && request.light->on_samples) {
  for (const Surface& surface : request.surfaces) {
    Level level{float(surface.value * largest_texel(volume.type)), surface.colour};
    for (std::size_t k = 0; k < 3; ++k) level.colour[k] *= level.colour[3];
    levels.push_back(level);
  }
  std::stable_sort(levels.begin(), levels.end(),
                   [](const Level& a, const Level& b) { return a.value < b.value; });
  if (request.light) prepared_light.emplace(*request.light, volume);
}

}  // namespace understudy::volume
