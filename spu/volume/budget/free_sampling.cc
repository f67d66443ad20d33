// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/budget/free_sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "volume/footprint.h"
#include "volume/matrix.h"
#include "volume/opacity_correction.h"

namespace understudy::spu {
namespace {

using volume::RenderRequest;
using volume::Rgba;
using volume::TransferFunction;
using volume::Vec3;

/// Returns what in a request has no meaning without its own samples, if anything.
std::optional<std::string> obstacle(const RenderRequest& request) {
  if (std::holds_alternative<volume::LinearMap>(request.classification))
    return "the texels are colours already, whose opacities are of the viewer's own samples";
  if (!std::holds_alternative<TransferFunction>(request.classification))
    return "a pre-integration table is of the viewer's own segments";
  if (request.op != volume::Operator::over) return "samples are not composed by over";
  if (request.filter != volume::Filter::linear) return "the filter is nearest, which has no samples in between";
  if (request.fog) return "samples fade in fog";
  if (request.light || !request.surfaces.empty()) return "no integral is defined for surfaces and light";
  if (volume::needs_whole_rays(request))
    return "rays end at an opacity that depends on the viewer's own samples";
  return std::nullopt;
}

/// Clamps entries to values that a medium can have: entries measured on a program may be off by rounding.
TransferFunction believable(TransferFunction function) {
  for (Rgba& entry : function.entries) {
    for (float& value : entry) value = std::isfinite(value) ? std::max(value, 0.0F) : 0.0F;
    entry[3] = std::min(entry[3], 1.0F);
  }
  return function;
}

/// Direction of the ray through the middle of the image towards the far plane, not normalised.
std::optional<Vec3> middle_ray(const RenderRequest& request) {
  const auto clip_to_texture = volume::inverse(request.texture_to_clip);
  if (!clip_to_texture) return std::nullopt;
  const volume::Rect seen = volume::footprint(request, request.region);
  if (seen.empty()) return std::nullopt;
  const double across = 2 * (seen.x + seen.width / 2.0 - request.viewport.x) / request.viewport.width - 1;
  const double up = 2 * (seen.y + seen.height / 2.0 - request.viewport.y) / request.viewport.height - 1;
  const auto point_at = [&](double depth) {
    const volume::Vec4 p = volume::transform(*clip_to_texture, {across, up, depth, 1});
    return Vec3{p[0] / p[3], p[1] / p[3], p[2] / p[3]};
  };
  return volume::subtract(point_at(1), point_at(-1));
}

double steps_along(const volume::RaySteps& steps, const Vec3& way) {
  Vec3 in_steps{};
  for (std::size_t row = 0; row < 3; ++row)
    in_steps[row] =
        volume::dot({steps.metric[3 * row], steps.metric[3 * row + 1], steps.metric[3 * row + 2]}, way);
  return volume::length(in_steps);
}

}  // namespace

std::string name_of(const Setting& setting) {
  return fmt::format("{} of {:.4g} of the application's steps, early ray termination below {:.1e}{}",
                     setting.method == volume::Method::pre_integrated ? "pre-integrated segments" : "samples",
                     setting.step, setting.termination, setting.as_halves ? ", half floats between nodes" : "");
}

std::variant<Meaning, std::string> meaning_of(const RenderRequest& request, const std::array<int, 3>& size) {
  if (auto reason = obstacle(request)) return *std::move(reason);
  Meaning meaning{request};
  RenderRequest& meant = meaning.request;
  meant.opacity_limit = 1;  // the integral has none, and a limit that is no obstacle hides hardly anything
  meant.classification = believable(std::get<TransferFunction>(request.classification));
  const auto way = middle_ray(request);
  if (!way) return "nothing of it is in the image";
  volume::RaySteps steps;
  if (request.steps) {
    steps.metric = request.steps->metric;
  } else {
    const Vec3 normal = volume::scale(request.planes.normal, 1 / request.planes.spacing);
    if (!(volume::dot(normal, *way) > 0)) return "slices are composed from the far end";
    std::copy(normal.begin(), normal.end(), steps.metric.begin());
  }
  meant.steps = steps;
  Vec3 in_texels{};
  for (std::size_t k = 0; k < 3; ++k) in_texels[k] = (*way)[k] * size[k];
  meaning.texels_a_step = volume::length(in_texels) / steps_along(steps, *way);
  if (!std::isfinite(meaning.texels_a_step) || !(meaning.texels_a_step > 0)) return "rays run along the slices";
  return meaning;
}

RenderRequest placed_as(const Meaning& meaning, const Setting& setting) {
  RenderRequest request = meaning.request;
  for (double& value : request.steps->metric) value /= setting.step;
  // Segments cover the ray from its entry on; a sample stands for half a step on either side.
  request.steps->first = setting.method == volume::Method::pre_integrated ? 0 : 0.5;
  request.method = setting.method;
  if (request.termination > 0) request.termination = setting.termination;  // else rays do not end early
  request.steps->cover_whole_ray = may_cover_whole_rays(request);
  request.may_travel_as_halves = setting.as_halves;
  return request;
}

TransferFunction table_as(const Meaning& meaning, const Setting& setting) {
  // The time to compute a pre-integration table is quadratic in its entries.
  const std::size_t most_entries = setting.method == volume::Method::pre_integrated ? 512 : 1024;
  return volume::opacity_corrected(std::get<TransferFunction>(meaning.request.classification), setting.step,
                                   most_entries);
}

RenderRequest sampled_as(const Meaning& meaning, const Setting& setting) {
  RenderRequest request = placed_as(meaning, setting);
  request.classification = table_as(meaning, setting);
  return request;
}

}  // namespace understudy::spu
