// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/gradient_opacity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/plain_tables.h"
#include "spu/volume/proxy/ray_normals.h"
#include "spu/volume/proxy/slope_probe.h"
#include "spu/volume/proxy/step_fit.h"
#include "spu/volume/texture/texture_parameter.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::GradientOpacity;
using volume::Rgba;
using volume::Vec3;

namespace {

const Refusal unknown_opacity{
    "opacity depends on how steep a gradient is in another way than by one table of its length"};

constexpr FieldProbe::PlainTable white(const SampledTexture& table) {
  return {table, {1, 1, 1, 1}};
}

/// The program's own table for as long as it lives, and the white one again then.
class OwnTable {
 public:
  OwnTable(FieldProbe& probe, const SampledTexture& table) : probe_(probe), table_(table) {
    probe_.show_own(table_);
  }
  ~OwnTable() { probe_.show_plain(white(table_)); }
  OwnTable(const OwnTable&) = delete;
  OwnTable& operator=(const OwnTable&) = delete;

 private:
  FieldProbe& probe_;
  const SampledTexture& table_;
};

/// One channel of the texels that are looked up by the first coordinate; empty where they are not filtered
/// linearly, the ends do not hold beyond, or there are several rows that differ. The program's own texture is
/// bound.
std::vector<float> factors_in(const GlContext& context, const SampledTexture& table, std::size_t channel) {
  constexpr GLint most_rows = 16;
  const DispatchTable& gl = *context.gl;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + table.unit));
  const GLint sampler = bound_sampler(context);
  GLint width = 0;
  GLint height = 0;
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_WIDTH, &width);
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_HEIGHT, &height);
  const GLint wrap = texture_parameter(gl, table.target, sampler, GL_TEXTURE_WRAP_S);
  std::vector<float> factors;
  if (width >= 1 && width <= GLint(volume::max_gradient_opacities) && height >= 1 && height <= most_rows &&
      (wrap == GL_CLAMP_TO_EDGE || wrap == GL_CLAMP) &&
      texture_parameter(gl, table.target, sampler, GL_TEXTURE_MAG_FILTER) == GL_LINEAR) {
    std::vector<Rgba> texels(std::size_t(width) * std::size_t(height));
    gl.GetTexImage(table.target, 0, GL_RGBA, GL_FLOAT, texels.data());
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const float factor = std::clamp(texels[i][channel], 0.0F, 1.0F);
      if (i < std::size_t(width)) factors.push_back(factor);
      if (factors[i % std::size_t(width)] == factor) continue;
      factors.clear();
      break;
    }
  }
  gl.ActiveTexture(GLenum(active));
  if (factors.size() == 1) factors.push_back(factors.front());
  return factors;
}

/// Factors whose table is looked up at 1 by slopes of `steepest`.
GradientOpacity over_slopes(std::vector<float> factors, double steepest) {
  const double half_texel = 0.5 / double(factors.size());
  return {std::move(factors), half_texel * steepest, (1 - half_texel) * steepest};
}

/// One ray under tables of one colour: of every sample the opacity is the same, times what the gradient makes
/// of it.
class FadedRay {
 public:
  FadedRay(FieldProbe& probe, SlopeProbe& slopes, const March& march, const LitRay& ray)
      : probe_(probe),
        slopes_(slopes),
        steps_(march.steps),
        ray_(ray),
        samples_(double(places_on_way(march.steps, ray.way.way).size())) {}

  /// Of samples that are looked up at `coordinate` under the table of coordinates, those of an unfaded one.
  double depth_at(double coordinate) const {
    return std::log1p(-ray_.plain_opacity * coordinate) / std::log1p(-ray_.plain_opacity);
  }
  struct Stripes {
    std::size_t axis = 0;
    int width = 1;  ///< in multiples of FieldProbe::split_unit
    double difference = 0;
  };
  /// The samples' optical depths, in those of an unfaded one, on average over where stripes begin.
  std::optional<double> depth_over(const Stripes& stripes, int shifts) const;
  /// The ray's opacity over an even slope, less what `opacity` makes of it in `space`; null: nothing is seen.
  std::optional<double> unexplained(const Vec3& gradient, double steepness, const volume::Light& light,
                                    const GradientOpacity& opacity) const;

 private:
  FieldProbe& probe_;
  SlopeProbe& slopes_;
  const volume::RaySteps& steps_;
  const LitRay& ray_;
  double samples_ = 0;
};

std::optional<double> FadedRay::depth_over(const Stripes& stripes, int shifts) const {
  std::vector<FieldProbe::StripedField> fields;
  const float half = float(stripes.difference / 2);
  for (int i = 0; i < shifts; ++i) {
    FieldProbe::StripedField field{stripes.axis, stripes.width, 2 * stripes.width * i / shifts, {}};
    field.values = {ray_.values.front() - half, ray_.values.front() + half};
    field.tables = ray_.tables.front();
    fields.push_back(field);
  }
  double depth = 0;
  for (const Rgba& shown : probe_.at_stripes(ray_.x, ray_.y, fields)) {
    if (shown[3] == no_fragment || !(shown[3] >= 0 && shown[3] < 1)) return std::nullopt;
    depth += std::log1p(-double(shown[3])) / std::log1p(-ray_.plain_opacity);
  }
  return depth / (shifts * samples_);
}

std::optional<double> FadedRay::unexplained(const Vec3& gradient, double steepness, const volume::Light& light,
                                            const GradientOpacity& opacity) const {
  const LightSpace space(light, ray_.way.way);
  const EvenRise field = slopes_.rise(gradient, steepness, light.reach);
  const std::vector<Rgba> shown = slopes_.over(ray_, {ray_.values.front()}, gradient, steepness);
  if (shown.front()[3] == no_fragment) return std::nullopt;
  double through = 1;
  for (const double place : places_on_way(steps_, ray_.way.way)) {
    const Vec3 point = volume::add(ray_.way.entry, volume::scale(ray_.way.way, place));
    through *= 1 - ray_.plain_opacity * opacity.at(space.slope(seen_gradient(field, point)));
  }
  return double(shown.front()[3]) - (1 - through);
}

/// How a program looks gradients along one axis up.
struct AxisLookup {
  double reach = 1;       ///< in texels of the volume
  double coordinate = 0;  ///< in the table, of a slope of 1 per unit of texture space
};

/// By stripes: samples within reach of where two meet have a gradient. So steep a one that it is looked up at
/// the table's end tells the reach, a gentler one the coordinate.
std::optional<AxisLookup> lookup_along(const FadedRay& ray, const SlopeProbe& slopes, std::size_t axis,
                                       const std::array<int, 3>& size, double range) {
  constexpr int shifts = 32;
  constexpr int few = 4;
  constexpr double steepest = 1e4;
  constexpr double wanted = 0.5;
  // Several texels of the volume, or gradients would reach across.
  FadedRay::Stripes stripes{axis, std::clamp(4 * FieldProbe::field_texels / size[axis], 32, 128),
                            steepest * range};
  const auto saturated = ray.depth_over(stripes, shifts);
  if (!saturated || !(*saturated > 0.002 && *saturated < 0.9)) return std::nullopt;
  // What depth the samples at one coordinate come to.
  const auto coordinate_of = [&](double depth) {
    double low = 0;
    double high = 1;
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      (ray.depth_at(middle) * *saturated < depth ? low : high) = middle;
    }
    return low;
  };
  for (int halvings = 0; halvings < 40; ++halvings) {
    const auto depth = ray.depth_over(stripes, few);
    if (!depth) return std::nullopt;
    if (coordinate_of(*depth) < wanted) break;
    stripes.difference /= 2;
  }
  const auto depth = ray.depth_over(stripes, shifts);
  if (!depth) return std::nullopt;
  const double coordinate = coordinate_of(*depth);
  if (!(coordinate > 0.05 && coordinate < 0.95)) return std::nullopt;
  const double part = *saturated * stripes.width * FieldProbe::split_unit / 2;
  const double texels = slopes.reach_in_stripes(axis, part);
  // Whole texels or halves, but for what counting samples leaves open.
  const double halves = std::round(2 * texels) / 2;
  const double reach = halves >= 0.5 && std::abs(texels - halves) < 0.15 ? halves : texels;
  return AxisLookup{reach, coordinate / stripes.difference * 2 * reach / size[axis]};
}

/// The slope, per unit of length of the light's space, that is looked up at the table's end; null where axes
/// differ in it.
std::optional<double> steepest_in_table(const LightSpace& space,
                                        std::span<const std::optional<AxisLookup>> axes) {
  constexpr double same = 0.03;
  std::vector<double> found;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!axes[axis]) continue;
    Vec3 along{};
    along[axis] = 1;
    found.push_back(space.slope(along) / axes[axis]->coordinate);
  }
  const auto [least, most] = std::ranges::minmax(found);
  if (most > (1 + same) * least) return std::nullopt;
  double sum = 0;
  for (const double steepest : found) sum += steepest;
  return sum / double(found.size());
}

/// Gradients as the table's coordinates measure them: of length 1 at its end.
void take_space(std::span<const std::optional<AxisLookup>> axes, const std::array<int, 3>& size,
                volume::Light& light) {
  std::size_t known = 0;
  while (!axes[known]) ++known;
  light.space = {};
  for (std::size_t k = 0; k < 3; ++k) {
    // Where the ray does not tell, texels are cubes.
    const AxisLookup axis =
        axes[k].value_or(AxisLookup{axes[known]->reach, axes[known]->coordinate * size[known] / size[k]});
    light.space[4 * k] = 1 / axis.coordinate;
    light.reach[k] = axis.reach;
  }
}

/// Slopes that differ in direction and steepness.
constexpr std::array<Vec3, 4> directions{{{1, 0.4, -0.3}, {-0.2, 1, 0.5}, {0.3, -0.6, 1}, {1, 1, 1}}};

/// Whether the ray's opacities are those of `opacity`, of a slope that is looked up at each of these
/// coordinates.
bool is_explained(const FadedRay& ray, const SlopeProbe& slopes, const Vec3& way, const volume::Light& light,
                  const GradientOpacity& opacity, std::span<const Vec3> gradients,
                  std::span<const double> coordinates) {
  constexpr double same = 0.02;
  const LightSpace space(light, way);
  const double steepest = opacity.first + opacity.last;
  for (const Vec3& gradient : gradients) {
    const double unit = space.slope(slopes.rise(gradient, 1, light.reach).gradient);
    for (const double coordinate : coordinates) {
      const auto rest = ray.unexplained(gradient, coordinate * steepest / unit, light, opacity);
      if (!rest || !(std::abs(*rest) <= same)) return false;
    }
  }
  return true;
}

}  // namespace

volume::Light light_that_changes_nothing() {
  volume::Light light;
  light.ambient = light.specular = {0, 0, 0};
  light.diffuse = {1, 1, 1};
  light.response = {{1, 0}, {1, 0}};
  return light;
}

std::optional<Refusal> measure_gradient_opacity(const MarchContext& measured, FieldProbe& probe,
                                                const ProxyBox& box, bool lit, March& march,
                                                std::vector<volume::Light>& lights) {
  const std::vector<SampledTexture> tables = gradient_tables(measured);
  if (measured.tables_of_gradients.size() != 1 || tables.size() != 1) return unknown_opacity;
  const SampledTexture& table = tables.front();
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const std::vector<LitRay> longest = long_rays(rays, march.steps);
  if (longest.empty()) return unknown_opacity;
  const auto plain = under_plain_tables(measured, probe, march, longest.front());
  if (!plain) return unknown_opacity;
  if (!march.plain_tables) march.plain_tables = plain->tables;
  const FadedRay ray(probe, slopes, march, plain->ray);
  std::array<std::optional<AxisLookup>, 3> axes;
  probe.show_coordinate(table);
  for (std::size_t axis = 0; axis < 3; ++axis)
    axes[axis] = lookup_along(ray, slopes, axis, measured.texture.size,
                              double(measured.range[1]) - double(measured.range[0]));
  probe.show_plain(white(table));
  if (std::ranges::none_of(axes, [](const auto& axis) { return axis.has_value(); })) return unknown_opacity;
  if (!lit) {
    volume::Light light = light_that_changes_nothing();
    take_space(axes, measured.texture.size, light);
    lights = {light};
  }
  for (volume::Light& light : lights) {
    const auto steepest = steepest_in_table(LightSpace(light, plain->ray.way.way), axes);
    if (!steepest) return unknown_opacity;
    light.gradient_opacity = {{}, 0, *steepest};
  }
  const OwnTable own(probe, table);
  const auto explains = [&](const volume::Light& light) {
    constexpr std::array coordinates{0.03, 0.15, 0.4, 0.8};
    return is_explained(ray, slopes, plain->ray.way.way, light, light.gradient_opacity, directions,
                        coordinates);
  };
  // Red in VTK's.
  for (const std::size_t channel : {0U, 3U, 1U, 2U}) {
    const std::vector<float> factors = factors_in(measured.context, table, channel);
    if (factors.empty()) continue;
    for (volume::Light& light : lights)
      light.gradient_opacity = over_slopes(factors, light.gradient_opacity.first + light.gradient_opacity.last);
    march.gradient_opacity_channel = channel;
    if (std::ranges::all_of(lights, explains)) return std::nullopt;
  }
  return unknown_opacity;
}

std::optional<GradientOpacity> with_new_factors(const MarchContext& measured, const March& march) {
  const std::vector<SampledTexture> tables = gradient_tables(measured);
  if (tables.size() != 1) return std::nullopt;
  const SavedState saved(measured.context);
  std::vector<float> factors = factors_in(measured.context, tables.front(), march.gradient_opacity_channel);
  if (factors.empty()) return std::nullopt;
  const GradientOpacity& before = march.light->gradient_opacity;
  return over_slopes(std::move(factors), before.first + before.last);
}

bool still_fades_by_gradient(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                             const March& march) {
  const std::vector<SampledTexture> tables = gradient_tables(measured);
  if (tables.size() != 1) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const std::vector<LitRay> longest = long_rays(rays, march.steps);
  if (longest.empty()) return true;
  const auto plain = under_known_tables(measured, probe, march, longest.front());
  if (!plain) return false;
  const FadedRay ray(probe, slopes, march, *plain);
  const OwnTable own(probe, tables.front());
  constexpr std::array coordinates{0.1, 0.5};
  return is_explained(ray, slopes, plain->way.way, *march.light, march.light->gradient_opacity,
                      std::span(directions).first(1), coordinates);
}

}  // namespace understudy::spu
