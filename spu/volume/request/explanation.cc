// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/request/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

std::string_view name_of(volume::TexelType type) {
  switch (type) {
    case volume::TexelType::u8:
      return "8-bit";
    case volume::TexelType::u16:
      return "16-bit";
    case volume::TexelType::f32:
      return "float";
    default:
      return "RGBA";
  }
}

std::string_view name_of(volume::Filter filter) {
  switch (filter) {
    case volume::Filter::nearest:
      return "nearest";
    case volume::Filter::linear:
      return "linear";
    case volume::Filter::linear_8_bit:
      return "8-bit linear";
  }
  return "";
}

const char* name_of(const Blending& blending) {
  if (blending.front_to_back != FrontToBack::no) return "under";
  switch (blending.op) {
    case volume::Operator::over:
      return "over";
    case volume::Operator::max:
      return "maximum";
    case volume::Operator::min:
      return "minimum";
    case volume::Operator::add:
      return "sum";
    case volume::Operator::first_hit:
      return "first hit";
  }
  return "";
}

/// Describes where the samples lie.
std::string sampling_of(const volume::RenderRequest& request, const std::array<int, 3>& size, bool cut_rays) {
  if (!request.steps) {
    return fmt::format("{} slices {:.5f} of the texture apart", request.planes.count,
                       std::abs(request.planes.spacing));
  }
  const volume::RaySteps& steps = *request.steps;
  std::array<double, 3> a_texel{};
  for (std::size_t k = 0; k < 3; ++k) {
    a_texel[k] = volume::length({steps.metric[k], steps.metric[3 + k], steps.metric[6 + k]}) / size[k];
  }
  const std::string_view jitter = !steps.offsets ? ""
                                  : cut_rays     ? ", every ray from the planes that cut the box"
                                                 : ", every ray later by a number of its own";
  const std::string counted = steps.counted_from
                                  ? fmt::format(", as many as if it were {} in", *steps.counted_from)
                              : steps.at_least_one ? ", at least one on every ray"
                                                   : "";
  return fmt::format("a ray caster's box, {:.3f} x {:.3f} x {:.3f} {} a texel, the first sample {} in{}{}{}",
                     a_texel[0], a_texel[1], a_texel[2], steps.divided ? "equal parts" : "steps", steps.first,
                     counted, jitter,
                     request.op == volume::Operator::max   ? ", maximum"
                     : request.op == volume::Operator::min ? ", minimum"
                     : request.op == volume::Operator::add ? ", sum"
                                                           : "");
}

}  // namespace

std::string explanation(const Pipeline& pipeline, const TextureDescription& texture, const ImageRequest& image,
                        double residual) {
  const volume::RenderRequest& request = image.request;
  const volume::Matrix4& a = request.texture_to_clip;
  const bool perspective = std::abs(a[12]) + std::abs(a[13]) + std::abs(a[14]) > 1e-9 * std::abs(a[15]);
  const std::string_view colours = std::holds_alternative<volume::LinearMap>(request.classification)
                                       ? "colours in the texels"
                                   : request.slice_segment ? "pre-integration table probed from the program"
                                   : pipeline.program != 0 ? "table probed from the program"
                                   : !pipeline.assembly.empty() ? "table probed from the assembly program"
                                                                : "table probed from fixed function";
  return fmt::format(
      "{}x{}x{} {} texels ({}), {}, {} filter, {}, {} camera, fit to {:.1e}, {} of {} colours, {} clip planes, "
      "{}{}{}",
      texture.size[0], texture.size[1], texture.size[2], name_of(texture.type), texture.format_name,
      sampling_of(request, texture.size, !image.ray_ends.empty()), name_of(request.filter), colours,
      perspective ? "perspective" : "parallel", residual, name_of(pipeline.blending),
      pipeline.blending.premultiplied ? "premultiplied" : "plain", request.clip_planes.size(),
      request.depth ? "hidden by opaque geometry" : "no opaque geometry before it",
      request.fog ? ", fading in fog" : "",
      request.light && !request.light->gradient_opacity.factors.empty() ? ", gradient opacity" : "");
}

}  // namespace understudy::spu
