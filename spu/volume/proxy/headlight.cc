// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/headlight.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "spu/volume/proxy/clamped_light.h"
#include "spu/volume/proxy/facing_colours.h"
#include "spu/volume/proxy/gradient_reach.h"
#include "spu/volume/proxy/light_colours.h"
#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/march_table.h"
#include "spu/volume/proxy/normal_guard.h"
#include "spu/volume/proxy/plain_tables.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/slope_probe.h"
#include "spu/volume/proxy/steepness.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr int coarse_texels = 16;  ///< of fields that are drawn in many frames
constexpr int angles = 65;         ///< between normal and ray, from 0 to pi
constexpr int responses = 1025;    ///< of volume::Light
constexpr float another_opacity = 0.1F;
constexpr double golden = 2.39996;  ///< golden angle, in radians: its multiples stay apart for long

const Refusal not_from_the_eye{"the light does not shine from the eye"};
const Refusal depends_on_steepness{"colour or opacity depend on how steep a gradient is"};
const Refusal another_colour{"slopes are shown in colours that no light makes of those of even fields"};

/// What a ray shows over a slope.
struct SeenSlope {
  volume::Vec3 gradient{};    ///< in texture space
  double cosine = 0;          ///< between its normal and the direction to the eye
  std::vector<Tint> tints{};  ///< of the ray's values
};

/// A slope to probe, by the angle of its normal to the eye and its turn about the ray, in radians.
struct LookedAt {
  double angle = 0;
  double turn = 0;
};

/// Returns what the ray shows over these slopes; empty if one shows nothing, or another opacity than constant
/// fields.
std::vector<SeenSlope> seen_slopes(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::span<const LookedAt> looked_at, int texels = slope_texels) {
  std::vector<volume::Vec3> gradients;
  gradients.reserve(looked_at.size());
  for (const LookedAt& slope : looked_at) gradients.push_back(directions.gradient(slope.angle, slope.turn));
  const std::vector<Rgba> shown = slopes.over_steep(ray, ray.values, gradients, texels);
  std::vector<SeenSlope> seen;
  for (std::size_t i = 0; i < looked_at.size(); ++i) {
    const std::span of_slope = std::span(shown).subspan(i * ray.values.size(), ray.values.size());
    for (std::size_t v = 0; v < of_slope.size(); ++v) {
      if (!reached(of_slope[v]) || !(std::abs(of_slope[v][3] - ray.base[v][3]) < another_opacity) ||
          !(of_slope[v][3] > 0))
        return {};
    }
    seen.push_back({gradients[i], std::cos(looked_at[i].angle), tints_of({of_slope.begin(), of_slope.end()})});
  }
  return seen;
}

/// Returns what `light` predicts for a slope, value by value, given the reach of gradients.
std::vector<Tint> expected_tints(const SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                 const volume::Light& light, const SeenSlope& seen, int texels = slope_texels) {
  const LightSpace directions(light, ray.way.way);
  std::vector<Tint> tints;
  for (std::size_t v = 0; v < ray.values.size(); ++v) {
    const auto opacities = slopes.opacities_over_steep(ray, ray.values[v], seen.gradient, texels);
    const EvenRise rise = slopes.rise(seen.gradient, slopes.steepness_over(ray, ray.values[v], seen.gradient),
                                      light.reach, texels);
    const auto normals = ray_normals(ray.way, steps, opacities, directions, rise, light.guard);
    tints.push_back(lit_tint(light, normals, tint_of(ray.base[v])));
  }
  return tints;
}

/// Returns slopes at a few angles to the eye, each turned about the ray; empty if nothing is visible.
std::vector<std::vector<SeenSlope>> turned_slopes(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::Light& light) {
  constexpr std::size_t turns = 4;
  std::vector<LookedAt> looked_at;
  for (const double angle : {0.4, 0.8, 1.2, 2.2}) {
    for (std::size_t i = 0; i < turns; ++i) looked_at.push_back({angle, 0.3 + M_PI / 2 * double(i)});
  }
  const std::vector<SeenSlope> seen = seen_slopes(slopes, ray, LightSpace(light, ray.way.way), looked_at);
  std::vector<std::vector<SeenSlope>> turned;
  for (auto at_angle = seen.begin(); at_angle != seen.end(); at_angle += turns)
    turned.emplace_back(at_angle, at_angle + turns);
  return turned;
}

/// Returns by how much slopes at one angle differ, relative to the brightest of all; 0 if the angle to the eye
/// alone decides.
double difference_when_turned(const std::vector<std::vector<SeenSlope>>& turned) {
  double most = 1e-6;
  double differ = 0;
  for (const std::vector<SeenSlope>& at_angle : turned) {
    for (const SeenSlope& seen : at_angle) {
      most = std::max(most, brightest(seen.tints));
      for (std::size_t v = 0; v < seen.tints.size(); ++v)
        differ = std::max(differ, difference(seen.tints[v], at_angle.front().tints[v]));
    }
  }
  return differ / most;
}

using Matrix = std::array<double, 9>;

/// Whether two spaces differ by their unit of length alone, which no angle shows.
bool are_alike(const Matrix& a, const Matrix& b) {
  constexpr double same = 1e-3;
  const auto largest = [](const Matrix& m) {
    return std::abs(*std::ranges::max_element(m, {}, [](double v) { return std::abs(v); }));
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs(a[i] / largest(a) - b[i] / largest(b)) > same) return false;
  }
  return true;
}

/// Returns the spaces in which the program may take gradients or rays: that in which its steps have one length,
/// that in which texels are cubes, and texture space.
std::vector<Matrix> candidate_spaces(const MarchContext& measured, const March& march) {
  std::vector<Matrix> spaces;
  const auto add = [&](const Matrix& space) {
    if (std::ranges::none_of(spaces, [&](const Matrix& other) { return are_alike(space, other); }))
      spaces.push_back(space);
  };
  if (!march.steps.between_planes()) add(march.steps.metric);
  Matrix texels{};
  for (std::size_t k = 0; k < 3; ++k) texels[4 * k] = measured.texture.size[k];
  add(texels);
  add({1, 0, 0, 0, 1, 0, 0, 0, 1});
  return spaces;
}

/// Returns `light` with gradients and rays in the same one of `spaces`, and then with each in another one.
std::vector<volume::Light> in_all_spaces(volume::Light light, const std::vector<Matrix>& spaces) {
  std::vector<volume::Light> lights;
  for (const Matrix& space : spaces) {
    light.space = space;
    lights.push_back(light);
  }
  for (const Matrix& space : spaces) {
    for (const Matrix& rays : spaces) {
      if (rays == space) continue;
      light.space = space;
      light.ray_space = rays;
      lights.push_back(light);
    }
  }
  return lights;
}

struct LightInSpace {
  volume::Light light;
  std::vector<std::vector<SeenSlope>> turned;  ///< slopes as seen in that space, by angle
  double differ = 0;                           ///< by how much slopes of one angle differ
};

/// Returns the light in the spaces, up to three, in which the angle to the eye nearly decides alone, best
/// first. (Nearly, because samples at the texture's ends have other normals.)
std::vector<LightInSpace> in_likely_spaces(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                           const std::vector<Matrix>& spaces) {
  constexpr double at_most = 0.3;
  constexpr double surely = 0.05;
  constexpr std::size_t most = 3;
  std::vector<LightInSpace> likely;
  for (const volume::Light& in_space : in_all_spaces(light, spaces)) {
    auto turned = turned_slopes(slopes, ray, in_space);
    const double differ = difference_when_turned(turned);
    if (turned.empty() || !(differ < at_most)) continue;
    likely.push_back({in_space, std::move(turned), differ});
    if (differ < surely) break;
  }
  std::ranges::sort(likely, {}, &LightInSpace::differ);
  likely.resize(std::min(likely.size(), most));
  return likely;
}

/// Resamples a response from evenly spaced angles to evenly spaced cosines.
std::vector<volume::LightResponse> by_cosine(const std::vector<volume::LightResponse>& by_angle) {
  std::vector<volume::LightResponse> response;
  for (int i = 0; i < responses; ++i) {
    const double cosine = 2.0 * i / (responses - 1) - 1;
    const double place = std::acos(std::clamp(cosine, -1.0, 1.0)) / M_PI * double(by_angle.size() - 1);
    const std::size_t entry = std::min(std::size_t(place), by_angle.size() - 2);
    const float share = float(place - double(entry));
    const volume::LightResponse &low = by_angle[entry], &high = by_angle[entry + 1];
    response.push_back({low.diffuse + share * (high.diffuse - low.diffuse),
                        low.specular + share * (high.specular - low.specular)});
  }
  return response;
}

/// Whether a slope looks as `light` predicts. For VTK's light, and for 25 programs with light from the eye,
/// colours differ by up to 0.008.
bool is_explained(const SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                  const volume::Light& light, const SeenSlope& seen, int texels = slope_texels) {
  constexpr double same = 0.02;
  const std::vector<Tint> expected = expected_tints(slopes, ray, steps, light, seen, texels);
  for (std::size_t v = 0; v < expected.size(); ++v) {
    if (!(difference(seen.tints[v], expected[v]) <= same * std::max(1.0, brightest(seen.tints)))) return false;
  }
  return true;
}

/// Whether `ray` shows the light on these slopes.
bool shows_light(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                 const volume::Light& light, std::span<const LookedAt> looked_at, int texels) {
  const std::vector<SeenSlope> seen =
      seen_slopes(slopes, ray, LightSpace(light, ray.way.way), looked_at, texels);
  return !seen.empty() && std::ranges::all_of(seen, [&](const SeenSlope& slope) {
    return is_explained(slopes, ray, steps, light, slope, texels);
  });
}

/// Whether a short ray shows the light as bright as it was measured on a long one. More of its samples lie
/// close to the faces, where normals are less certain, so a highlight may differ by what a small angle changes.
bool shows_light_as_bright(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                           const volume::Light& light, std::span<const LookedAt> looked_at) {
  constexpr double same = 0.02;
  constexpr double angle_unsure = 0.03;
  const LightSpace directions(light, ray.way.way);
  const auto expected = [&](const LookedAt& slope, double aside) {
    return expected_tints(slopes, ray, steps, light, {directions.gradient(slope.angle + aside, slope.turn)});
  };
  const std::vector<SeenSlope> seen = seen_slopes(slopes, ray, directions, looked_at);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const LookedAt& slope = looked_at[i];
    const std::vector<Tint>& tints = seen[i].tints;
    const std::array all{expected(slope, 0), expected(slope, -angle_unsure), expected(slope, angle_unsure)};
    const double allowed = same * std::max(1.0, brightest(tints));
    for (std::size_t v = 0; v < tints.size(); ++v) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [least, most] = std::minmax({all[0][v][c], all[1][v][c], all[2][v][c]});
        if (tints[v][c] < least - allowed || tints[v][c] > most + allowed) return false;
      }
    }
  }
  return !seen.empty();
}

/// Fits the light to one ray's slopes at angles from 0 to pi, whatever other rays show. What samples at the
/// texture's ends contribute is removed as `light` predicts; if it has no response yet, it stays.
std::variant<volume::Light, Refusal> light_on(const SlopeProbe& slopes, const LitRay& ray,
                                              const volume::RaySteps& steps, const std::vector<SeenSlope>& seen,
                                              volume::Light light) {
  constexpr float same_before_correction = 0.1F;
  constexpr float same = 0.03F;
  const double allowed = double(light.response.empty() ? same_before_correction : same);
  const std::vector<Tint> base = tints_of(ray.base);
  std::vector<volume::LightResponse> by_angle;
  for (const SeenSlope& slope : seen) {
    std::vector<Tint> inside = slope.tints;
    if (!light.response.empty()) {
      const std::vector<Tint> expected = expected_tints(slopes, ray, steps, light, slope);
      for (std::size_t v = 0; v < inside.size(); ++v) {
        const Tint here = lit_tint(light, slope.cosine, base[v]);
        for (std::size_t c = 0; c < 3; ++c) inside[v][c] += here[c] - expected[v][c];
      }
    }
    const ResponseFit fit = response_fit(light, base, inside);
    if (!(fit.worst <= allowed * std::max(1.0, brightest(inside)))) return another_colour;
    by_angle.push_back(fit.response);
  }
  // Light this faint may appear on steeper slopes only, or be no light at all but a neighbour's value that
  // colours show a little. A fit that may be off by `same` distinguishes these only beyond twice that.
  constexpr float visible = 2 * same;
  if (light.even[0] > 0 && std::ranges::all_of(by_angle, [&](const volume::LightResponse& at) {
        return std::abs(at.diffuse - 1) < visible && std::abs(at.specular) < visible;
      }))
    return Refusal{gradients_change_no_colour};
  light.response = by_cosine(by_angle);
  return light;
}

/// Measures the light and the reach of its gradients in turn: each improves the other.
std::variant<volume::Light, Refusal> light_and_reach(SlopeProbe& slopes, const LitRay& ray,
                                                     const volume::RaySteps& steps, volume::Light light,
                                                     bool coloured) {
  constexpr int rounds = 2;
  constexpr int corrections = 4;
  std::vector<LookedAt> looked_at;
  looked_at.reserve(angles);
  for (int i = 0; i < angles; ++i) looked_at.push_back({M_PI * i / (angles - 1), golden * i});
  const std::vector<SeenSlope> seen = seen_slopes(slopes, ray, LightSpace(light, ray.way.way), looked_at);
  if (seen.empty()) return Refusal{"fields with a slope show nothing"};
  if (coloured) {
    // Samples at the texture's ends mix in what other angles show, but all of it is in the light's colours.
    std::vector<std::vector<Tint>> tints;
    tints.reserve(seen.size());
    for (const SeenSlope& slope : seen) tints.push_back(slope.tints);
    light = with_colours(std::move(light), tints_of(ray.base), tints);
  }
  auto found = light_on(slopes, ray, steps, seen, light);
  for (int round = 0; round < rounds; ++round) {
    if (!std::holds_alternative<volume::Light>(found)) return found;
    const auto reach = gradient_reach(slopes, ray, std::get<volume::Light>(found));
    if (!reach) return Refusal{"gradients look farther than eight texels"};
    for (int i = 0; i < corrections && std::holds_alternative<volume::Light>(found); ++i) {
      light = std::get<volume::Light>(found);
      light.reach = *reach;
      found = light_on(slopes, ray, steps, seen, light);
    }
  }
  return found;
}

/// Returns the light in that space, if it explains all slopes that were seen there.
std::variant<volume::Light, Refusal> light_that_explains(SlopeProbe& slopes, const LitRay& ray,
                                                         const volume::RaySteps& steps,
                                                         const LightInSpace& in_space, bool coloured) {
  auto found = light_and_reach(slopes, ray, steps, in_space.light, coloured);
  const auto* const light = std::get_if<volume::Light>(&found);
  if (light == nullptr) return found;
  for (const auto& at_angle : in_space.turned) {
    for (const SeenSlope& slope : at_angle) {
      if (!is_explained(slopes, ray, steps, *light, slope)) return not_from_the_eye;
    }
  }
  return found;
}

/// Returns the plainest light, in the likeliest of the spaces, that explains what is seen.
std::variant<volume::Light, Refusal> light_in_any(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::RaySteps& steps,
                                                  const std::vector<LightInSpace>& likely,
                                                  std::span<const bool> coloured) {
  std::variant<volume::Light, Refusal> found = not_from_the_eye;
  for (const bool with_colours : coloured) {
    for (const LightInSpace& in_space : likely) {
      found = light_that_explains(slopes, ray, steps, in_space, with_colours);
      if (std::holds_alternative<volume::Light>(found)) return found;
    }
  }
  return found;
}

/// Measures the light with the program's own colours.
std::variant<volume::Light, Refusal> light_on_own_ray(const MarchContext& measured, SlopeProbe& slopes,
                                                      const LitRay& ray, std::size_t axis_of_entry,
                                                      const March& march, const volume::Light& light) {
  const auto likely = in_likely_spaces(slopes, ray, light, candidate_spaces(measured, march));
  if (likely.empty()) return not_from_the_eye;
  if (!is_the_same_for_any_steepness(slopes, ray, LightSpace(likely.front().light, ray.way.way), axis_of_entry))
    return depends_on_steepness;
  // Base colours that are much alike say little about the light's colours: try white first.
  constexpr std::array white_first{false, true};
  return light_in_any(slopes, ray, march.steps, likely, white_first);
}

/// Measures the light under plain tables, whose colours determine the light's.
std::variant<volume::Light, Refusal> light_on_plain_ray(const MarchContext& measured, SlopeProbe& slopes,
                                                        const LitRay& plain, const March& march,
                                                        const volume::Light& light) {
  constexpr std::array coloured{true};
  return light_in_any(slopes, plain, march.steps,
                      in_likely_spaces(slopes, plain, light, candidate_spaces(measured, march)), coloured);
}

/// Returns `light`, which explains the steepest slopes of the `plain` ray, with the guard that explains gentler
/// ones. Checks it under the program's own table, which may be looked up by more than is known.
std::variant<volume::Light, Refusal> light_of_all_steepnesses(SlopeProbe& slopes, const LitRay& ray,
                                                              const LitRay& plain, std::size_t axis_of_entry,
                                                              const volume::RaySteps& steps,
                                                              const volume::Light& light) {
  auto guarded = with_normal_guard(slopes, plain, steps, light);
  if (!guarded || !is_lit_as_said_for_any_steepness(slopes, ray, steps, *guarded, axis_of_entry))
    return depends_on_steepness;
  return *std::move(guarded);
}

/// Returns a ray through the middle of the view, with a value that lets half of the light through: under the
/// plain tables of `march`, or the program's own tables. Null if nothing is translucent.
std::optional<LitRay> ray_of_half_seen_value(const MarchContext& measured, FieldProbe& probe,
                                             SlopeProbe& slopes, const RaysThroughBox& rays,
                                             const March& march) {
  const auto middle = rays.middle();
  const auto way = rays.through(middle[0], middle[1]);
  if (!way) return std::nullopt;
  LitRay ray{middle[0], middle[1], *way};
  if (march.plain_tables) return under_known_tables(measured, probe, march, ray);
  const auto value = half_seen_value(march, way->way);
  if (!value) return std::nullopt;
  ray.values = {*value};
  ray.base = slopes.base(ray.x, ray.y, ray.values);
  if (!is_translucent(ray.base.front())) return std::nullopt;
  return ray;
}

/// Returns those of `rays` on which values are translucent, with these values.
std::vector<LitRay> lit_rays(SlopeProbe& slopes, std::vector<LitRay> rays) {
  std::vector<LitRay> seen;
  for (LitRay& ray : rays) {
    LitRay with = slopes.with_values(std::move(ray));
    if (!with.values.empty()) seen.push_back(std::move(with));
  }
  return seen;
}

/// Likewise for long rays, or, if all values are dense, for brief ones.
std::vector<LitRay> lit_rays(SlopeProbe& slopes, const RaysThroughBox& rays, const volume::RaySteps& steps) {
  std::vector<LitRay> seen = lit_rays(slopes, long_rays(rays, steps));
  return seen.empty() ? lit_rays(slopes, brief_rays(rays, steps)) : seen;
}

}  // namespace

std::variant<std::vector<volume::Light>, Refusal> measure_headlight(const MarchContext& measured,
                                                                    FieldProbe& probe, const ProxyBox& box,
                                                                    March& march) {
  constexpr double darkest = 1e-3;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  volume::Light light;
  light.ambient = {0, 0, 0};
  light.diffuse = light.specular = {1, 1, 1};
  SlopeProbe slopes(measured, probe, march);
  std::vector<LitRay> seen = lit_rays(slopes, rays, march.steps);
  if (seen.empty()) return Refusal{"no value is translucent on any ray: light cannot be measured"};
  const auto is_black = [](const Rgba& colour) { return !(brightest_channel(colour) > darkest); };
  if (std::ranges::all_of(march.table.entries, is_black)) {
    light.even = {0, 0, 0};
    march.light = light;
    take_facing_colours(measured, probe, box, march);
    seen = lit_rays(slopes, rays, march.steps);
  }
  if (seen.empty() || std::ranges::all_of(seen.front().base, is_black))
    return Refusal{"neither even fields nor slopes have a colour under the light"};
  const LitRay& ray = seen.front();
  march.slope_steepness = slopes.allowed_steepness(ray);
  const std::size_t axis = axis_of_entry(box.region, ray.way);
  const auto plain =
      is_black_where_even(march) ? std::nullopt : under_plain_tables(measured, probe, march, ray);
  std::variant<volume::Light, Refusal> found = not_from_the_eye;
  if (plain) found = light_on_plain_ray(measured, slopes, plain->ray, march, light);
  if (const auto* const steep = std::get_if<volume::Light>(&found)) {
    march.plain_tables = plain->tables;
    found = light_of_all_steepnesses(slopes, ray, plain->ray, axis, march.steps, *steep);
  } else {
    found = light_on_own_ray(measured, slopes, ray, axis, march, light);
  }
  if (auto* const refusal = std::get_if<Refusal>(&found)) return std::move(*refusal);
  light = std::get<volume::Light>(std::move(found));
  constexpr std::array<LookedAt, 4> looked_at{{{0.2, 1.6}, {0.9, 3.7}, {1.5, 5.5}, {2.6, 8.8}}};
  for (const LitRay& other : std::span(seen).subspan(1)) {
    if (!shows_light(slopes, other, march.steps, light, looked_at, slope_texels))
      return Refusal{"the light does not shine along every ray"};
  }
  for (const LitRay& other :
       lit_rays(slopes, near_and_far_rays(rays, march.steps, box.camera.texture_to_clip))) {
    // In a highlight and beside it.
    if (!shows_light_as_bright(slopes, other, march.steps, light, std::span(looked_at).first(2)))
      return Refusal{"the light is not as bright at the back of the box as at its front"};
  }
  auto lights = without_and_with_clamp(slopes, ray, march.steps, axis, light, measured.range);
  if (lights.empty()) return another_colour;
  return lights;
}

bool still_lit(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, const March& march) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const auto ray = ray_of_half_seen_value(measured, probe, slopes, rays, march);
  if (!ray) return !rays.way(rays.middle()[0], rays.middle()[1]);
  // A light that has moved aside shows on slopes that lean towards it: two of these lean at right angles.
  constexpr std::array<LookedAt, 3> looked_at{{{0.3, 1.9}, {1.2, 4.6}, {1.2, 4.6 + M_PI / 2}}};
  return shows_light(slopes, *ray, march.steps, *march.light, looked_at, coarse_texels);
}

bool gradients_still_reach(const MarchContext& measured, const ProxyBox& box, const March& march,
                           std::span<const std::size_t> axes) {
  FieldProbe probe(measured);
  if (!probe.complete() || !held_still(measured, probe, march)) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const auto ray = ray_of_half_seen_value(measured, probe, slopes, rays, march);
  if (!ray) return false;
  return std::ranges::all_of(axes,
                             [&](std::size_t axis) { return still_reaches(slopes, *ray, *march.light, axis); });
}

}  // namespace understudy::spu
