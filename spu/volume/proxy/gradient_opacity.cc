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
#include "spu/volume/proxy/ray_probes.h"
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

/// Whether the table is filtered linearly, without mipmaps, and clamped to its edge. (Under GL_CLAMP the ends
/// mix with the border.)
bool is_plain_table(const GlContext& context, GLenum target) {
  const DispatchTable& gl = *context.gl;
  const GLint sampler = bound_sampler(context);
  const auto is = [&](GLenum name, GLint value) {
    return texture_parameter(gl, target, sampler, name) == value;
  };
  return is(GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE) && is(GL_TEXTURE_MIN_FILTER, GL_LINEAR) &&
         is(GL_TEXTURE_MAG_FILTER, GL_LINEAR) && texture_parameter(gl, target, 0, GL_TEXTURE_BASE_LEVEL) == 0;
}

/// Returns one channel of texels whose rows are alike; empty if they are not, or if a texel is outside [0, 1].
std::vector<float> factors_of(std::span<const Rgba> texels, std::size_t width, std::size_t channel) {
  std::vector<float> factors;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const float factor = texels[i][channel];
    if (!(factor >= 0 && factor <= 1)) return {};
    if (i < width) factors.push_back(factor);
    if (factors[i % width] != factor) return {};
  }
  if (factors.size() == 1) factors.push_back(factors.front());
  return factors;
}

/// Returns one channel of the texels, by the first coordinate; empty if values between or beyond the texels are
/// unknown. The program's own texture must be bound.
std::vector<float> factors_in(const GlContext& context, const SampledTexture& table, std::size_t channel) {
  constexpr GLint most_rows = 16;
  const DispatchTable& gl = *context.gl;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + table.unit));
  GLint width = 0;
  GLint height = 0;
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_WIDTH, &width);
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_HEIGHT, &height);
  std::vector<Rgba> texels;
  if (is_plain_table(context, table.target) && width >= 1 && width <= GLint(volume::max_gradient_opacities) &&
      height >= 1 && height <= most_rows) {
    texels.resize(std::size_t(width) * std::size_t(height));
    gl.GetTexImage(table.target, 0, GL_RGBA, GL_FLOAT, texels.data());
  }
  gl.ActiveTexture(GLenum(active));
  return factors_of(texels, std::size_t(std::max(width, 1)), channel);
}

/// Returns the factors of a table that is looked up at 1 by slopes of `steepest`.
GradientOpacity over_slopes(std::vector<float> factors, double steepest) {
  const double half_texel = 0.5 / double(factors.size());
  return {std::move(factors), half_texel * steepest, (1 - half_texel) * steepest};
}

/// One ray under tables of one colour: all samples have the same opacity, times the factor of their gradients.
class FadedRay {
 public:
  FadedRay(FieldProbe& probe, SlopeProbe& slopes, const March& march, const LitRay& ray)
      : probe_(probe),
        slopes_(slopes),
        steps_(march.steps),
        ray_(ray),
        samples_(double(places_on_way(march.steps, ray.way.way).size())) {}

  /// The optical depth of a sample that is looked up at `coordinate`, under the table of coordinates
  /// (FieldProbe::show_coordinate), relative to that of a sample under the white table.
  double depth_at(double coordinate) const {
    return std::log1p(-ray_.plain_opacity * coordinate) / std::log1p(-ray_.plain_opacity);
  }
  struct Stripes {
    std::size_t axis = 0;
    int width = 1;  ///< in multiples of FieldProbe::split_unit
    double difference = 0;
  };
  /// The samples' mean relative optical depth, averaged over shifts of the stripes; null if it cannot be
  /// measured.
  std::optional<double> depth_over(const Stripes& stripes, int shifts) const;
  /// What the ray shows over a linear field, premultiplied.
  Rgba over(const Vec3& gradient, double steepness) const;
  /// The ray's opacity over that field as `opacity` predicts it, in the space of `light`.
  double opacity_over(const Vec3& gradient, double steepness, const volume::Light& light,
                      const GradientOpacity& opacity) const;
  const Vec3& way() const { return ray_.way.way; }
  const SlopeProbe& slopes() const { return slopes_; }

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

Rgba FadedRay::over(const Vec3& gradient, double steepness) const {
  return slopes_.over(ray_, {ray_.values.front()}, gradient, steepness).front();
}

double FadedRay::opacity_over(const Vec3& gradient, double steepness, const volume::Light& light,
                              const GradientOpacity& opacity) const {
  const LightSpace space(light, ray_.way.way);
  const EvenRise field = slopes_.rise(gradient, steepness, light.reach);
  double through = 1;
  for (const double place : places_on_way(steps_, ray_.way.way)) {
    const Vec3 point = volume::add(ray_.way.entry, volume::scale(ray_.way.way, place));
    through *= 1 - ray_.plain_opacity * opacity.at(space.slope(seen_gradient(field, point)));
  }
  return 1 - through;
}

/// How a program looks up gradients along one axis.
struct AxisLookup {
  double reach = 1;       ///< in texels of the volume
  double coordinate = 0;  ///< coordinate in the table of a slope of 1 per unit of texture space
};

/// Measures the lookup on stripes: samples within reach of a boundary between two stripes have a gradient.
/// While all of these are looked up at the table's end, their number gives the reach; gentler gradients then
/// give the coordinate.
std::optional<AxisLookup> lookup_along(const FadedRay& ray, const SlopeProbe& slopes, std::size_t axis,
                                       const std::array<int, 3>& size, double range) {
  constexpr int shifts = 32;
  constexpr int few = 4;
  constexpr double steepest = 1e4;
  constexpr double wanted = 0.5;
  // Stripes are several texels of the volume wide, or gradients would reach across them.
  FadedRay::Stripes stripes{axis, std::clamp(4 * FieldProbe::field_texels / size[axis], 32, 128),
                            steepest * range};
  const auto saturated = ray.depth_over(stripes, shifts);
  if (!saturated || !(*saturated > 0.002 && *saturated < 0.9)) return std::nullopt;
  // The coordinate at which the samples would come to this depth.
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
  // Round to half texels where the error of counting samples permits.
  const double halves = std::round(2 * texels) / 2;
  const double reach = halves >= 0.5 && std::abs(texels - halves) < 0.15 ? halves : texels;
  return AxisLookup{reach, coordinate / stripes.difference * 2 * reach / size[axis]};
}

/// Returns the slope, per unit of length of the light's space, that is looked up at the table's end; null if
/// the axes disagree.
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

/// Gives `light` the reach of gradients, and the space in which a gradient at the table's end has length 1.
void take_space(std::span<const std::optional<AxisLookup>> axes, const std::array<int, 3>& size,
                volume::Light& light) {
  std::size_t known = 0;
  while (!axes[known]) ++known;
  light.space = {};
  for (std::size_t k = 0; k < 3; ++k) {
    // For axes that the ray does not show, assume cubic texels.
    const AxisLookup axis =
        axes[k].value_or(AxisLookup{axes[known]->reach, axes[known]->coordinate * size[known] / size[k]});
    light.space[4 * k] = 1 / axis.coordinate;
    light.reach[k] = axis.reach;
  }
}

/// Gradients that differ in direction and length.
constexpr std::array<Vec3, 4> directions{{{1, 0.4, -0.3}, {-0.2, 1, 0.5}, {0.3, -0.6, 1}, {1, 1, 1}}};

/// Returns the steepness with which a slope in `gradient` is looked up at the table's end.
double steepness_at_end(const FadedRay& ray, const Vec3& gradient, const volume::Light& light,
                        double steepest) {
  return steepest / LightSpace(light, ray.way()).slope(ray.slopes().rise(gradient, 1, light.reach).gradient);
}

/// Whether the ray's opacities are as `opacity` predicts, for slopes that are looked up at each of
/// `coordinates`.
bool is_explained(const FadedRay& ray, const volume::Light& light, const GradientOpacity& opacity,
                  double steepest, std::span<const Vec3> gradients, std::span<const double> coordinates,
                  double same) {
  for (const Vec3& gradient : gradients) {
    const double at_end = steepness_at_end(ray, gradient, light, steepest);
    for (const double coordinate : coordinates) {
      const Rgba shown = ray.over(gradient, coordinate * at_end);
      const double expected = ray.opacity_over(gradient, coordinate * at_end, light, opacity);
      if (shown[3] == no_fragment || !(std::abs(double(shown[3]) - expected) <= same)) return false;
    }
  }
  return true;
}

/// The gradient opacity of the table of coordinates.
GradientOpacity coordinates_over_slopes(double steepest) {
  return {{0, 1}, 0, steepest};
}

double steepest_of(const volume::Light& light) {
  return light.gradient_opacity.first + light.gradient_opacity.last;
}

/// Whether colours over opacities are the same under the program's own table as under the white one, which is
/// bound afterwards.
bool keeps_colours(FieldProbe& probe, const FadedRay& ray, const volume::Light& light) {
  constexpr double same = 0.02;
  constexpr float tells = 0.05F;
  for (const double coordinate : {0.15, 0.4, 0.8}) {
    const Vec3& gradient = directions.front();
    const double steepness = coordinate * steepness_at_end(ray, gradient, light, steepest_of(light));
    probe.show_own_gradient_tables();
    const Rgba faded = ray.over(gradient, steepness);
    probe.show_white_gradient_tables();
    const Rgba plain = ray.over(gradient, steepness);
    if (faded[3] < tells) continue;
    const Tint expected = tint_of(plain);
    if (difference(tint_of(faded), expected) > same * std::max(1.0, brightest({expected}))) return false;
  }
  return true;
}

volume::Light light_that_changes_nothing() {
  volume::Light light;
  light.ambient = light.specular = {0, 0, 0};
  light.diffuse = {1, 1, 1};
  light.response = {{1, 0}, {1, 0}};
  return light;
}

using AxisLookups = std::array<std::optional<AxisLookup>, 3>;

/// Returns the lookups along all axes; null if no axis shows its lookup.
std::optional<AxisLookups> lookups(const MarchContext& measured, const FadedRay& ray) {
  AxisLookups axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
    axes[axis] = lookup_along(ray, ray.slopes(), axis, measured.texture.size,
                              double(measured.range[1]) - double(measured.range[0]));
  if (std::ranges::none_of(axes, [](const auto& axis) { return axis.has_value(); })) return std::nullopt;
  return axes;
}

/// Whether the light's gradients reach as far as those that the table is looked up by.
bool reaches_agree(const AxisLookups& axes, const volume::Light& light) {
  constexpr double same = 0.25;  // of a texel
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes[axis] && std::abs(axes[axis]->reach - light.reach[axis]) > same) return false;
  }
  return true;
}

/// Gives the lights the scale of the table, with the table of coordinates for factors. False if no scale
/// explains what `ray`, a long one, and `brief`, of few dense samples, show under that table. (A program that
/// applies gradient opacity before it corrects opacities for its step shows other ones where samples are
/// dense.)
bool take_scales(const AxisLookups& axes, const FadedRay& ray, const FadedRay& brief,
                 std::vector<volume::Light>& lights) {
  constexpr std::array few{0.25, 0.5};
  constexpr std::array many{0.0, 0.1, 0.5, 1.5};
  return std::ranges::all_of(lights, [&](volume::Light& light) {
    const auto steepest = steepest_in_table(LightSpace(light, ray.way()), axes);
    if (!steepest || !reaches_agree(axes, light)) return false;
    light.gradient_opacity = coordinates_over_slopes(*steepest);
    return is_explained(ray, light, light.gradient_opacity, *steepest, std::span(directions).first(2), many,
                        0.02) &&
           is_explained(brief, light, light.gradient_opacity, *steepest, std::span(directions).first(1), few,
                        0.012);
  });
}

/// Gives the lights the factors of the channel that explains what the ray shows under the program's own table;
/// false if none does.
bool take_factors(const MarchContext& measured, FieldProbe& probe, const SampledTexture& table,
                  const FadedRay& ray, March& march, std::vector<volume::Light>& lights) {
  constexpr std::array coordinates{0.0, 0.03, 0.15, 0.4, 0.8, 1.5};
  // VTK reads the red channel.
  for (const std::size_t channel : {0U, 3U, 1U, 2U}) {
    probe.show_own_gradient_tables();
    const std::vector<float> factors = factors_in(measured.context, table, channel);
    if (factors.empty()) continue;
    march.gradient_opacity_channel = channel;
    const bool explains = std::ranges::all_of(lights, [&](volume::Light& light) {
      const double steepest = steepest_of(light);
      light.gradient_opacity = over_slopes(factors, steepest);
      return is_explained(ray, light, light.gradient_opacity, steepest, directions, coordinates, 0.02);
    });
    if (explains) return keeps_colours(probe, ray, lights.front());
  }
  return false;
}

/// Returns a ray of about `samples` samples under plain tables; null if there is none.
std::optional<RayUnderPlainTables> plain_ray(const MarchContext& measured, FieldProbe& probe,
                                             const March& march, const RaysThroughBox& rays, double samples) {
  const Ray ray = ray_of_length(rays, march.steps, samples + march.steps.first - 0.5);
  const auto way = rays.through(ray.x, ray.y);
  if (!way || std::abs(ray.length - samples) > 2) return std::nullopt;
  return under_plain_tables(measured, probe, march, LitRay{ray.x, ray.y, *way});
}

}  // namespace

std::optional<Refusal> measure_gradient_opacity(const MarchContext& measured, FieldProbe& probe,
                                                const ProxyBox& box, bool lit, March& march,
                                                std::vector<volume::Light>& lights) {
  constexpr double few_samples = 8;
  const std::vector<SampledTexture> tables = gradient_tables(measured);
  if (measured.tables_of_gradients.size() != 1 || tables.size() != 1) return unknown_opacity;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const std::vector<LitRay> longest = long_rays(rays, march.steps);
  if (longest.empty()) return unknown_opacity;
  const auto plain = under_plain_tables(measured, probe, march, longest.front());
  const auto plain_brief = plain_ray(measured, probe, march, rays, few_samples);
  if (!plain || !plain_brief) return unknown_opacity;
  march.tables_under_gradients = plain->tables;
  const FadedRay ray(probe, slopes, march, plain->ray);
  const FadedRay brief(probe, slopes, march, plain_brief->ray);
  probe.show_coordinate(tables.front());
  const auto axes = lookups(measured, ray);
  if (!axes) return unknown_opacity;
  if (!lit) {
    lights = {light_that_changes_nothing()};
    take_space(*axes, measured.texture.size, lights.front());
  }
  if (!take_scales(*axes, ray, brief, lights)) return unknown_opacity;
  if (!take_factors(measured, probe, tables.front(), ray, march, lights)) return unknown_opacity;
  return std::nullopt;
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

bool fades_by_gradient(const March& march) {
  return march.light && !march.light->gradient_opacity.factors.empty();
}

bool still_fades_by_gradient(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                             const March& march) {
  constexpr std::array coordinates{0.1, 0.5};
  const std::vector<SampledTexture> tables = gradient_tables(measured);
  if (tables.size() != 1) return false;
  const volume::Light& light = *march.light;
  probe.show_own_gradient_tables();
  const std::vector<float> factors =
      factors_in(measured.context, tables.front(), march.gradient_opacity_channel);
  probe.show_white_gradient_tables();
  if (factors != light.gradient_opacity.factors) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const std::vector<LitRay> longest = long_rays(rays, march.steps);
  if (longest.empty()) return true;
  March under_tables = march;
  under_tables.plain_tables = march.tables_under_gradients;
  const auto plain = under_known_tables(measured, probe, under_tables, longest.front());
  if (!plain) return false;
  SlopeProbe slopes(measured, probe, under_tables);
  const FadedRay ray(probe, slopes, march, *plain);
  // The table of coordinates shows where slopes are looked up, whatever the shape of the program's own table.
  probe.show_coordinate(tables.front());
  const bool holds = is_explained(ray, light, coordinates_over_slopes(steepest_of(light)), steepest_of(light),
                                  std::span(directions).first(1), coordinates, 0.02);
  probe.show_white_gradient_tables();
  return holds;
}

}  // namespace understudy::spu
