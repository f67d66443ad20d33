// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/jitter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

constexpr int largest_tile = 1024;  ///< edge, in texels

/// If more rays than this deviate from a pattern, the texture is read in another way.
constexpr double most_strayed = 0.01;

struct Tile {
  int width = 0;
  int height = 0;
  std::size_t texels() const { return std::size_t(width) * std::size_t(height); }
};

/// Returns the size of a texture that may hold noise; null for tables, depths and images.
std::optional<Tile> tile_of(const DispatchTable& gl, const SampledTexture& texture) {
  if (texture.target != GL_TEXTURE_2D || texture.texture == 0 || is_depth_texture(gl, texture))
    return std::nullopt;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + texture.unit));
  Tile tile;
  GLint type = 0;
  gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_RED_TYPE, &type);
  gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &tile.width);
  gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &tile.height);
  gl.ActiveTexture(GLenum(active));
  const bool table = tile.width < 2 || tile.height < 2;
  const bool integers = type == GL_INT || type == GL_UNSIGNED_INT;
  if (table || integers || tile.width > largest_tile || tile.height > largest_tile) return std::nullopt;
  return tile;
}

volume::RayOffsets scaled(volume::RayOffsets numbers, const Jitter& jitter) {
  for (float& number : numbers.steps) number = float(number * jitter.steps_per_unit);
  return numbers;
}

const SampledTexture* sampled_at(const Run& run, GLint sampler_location) {
  for (const SampledTexture& texture : run.pipeline().others) {
    if (texture.sampler_location == sampler_location) return &texture;
  }
  return nullptr;
}

/// Counts of samples by pixel; 0 where a ray produced no fragment.
class Counts {
 public:
  explicit Counts(const std::vector<CountedRay>& rays) {
    for (const CountedRay& ray : rays) samples_[{ray.x, ray.y}] = ray.samples;
  }
  double at(const CountedRay& ray) const {
    const auto found = samples_.find({ray.x, ray.y});
    return found == samples_.end() ? 0 : found->second;
  }

 private:
  std::map<std::pair<int, int>, double> samples_;
};

/// Returns the rays counted with `texels` in place of the texture; empty if they cannot be counted.
std::vector<CountedRay> counted_under(FieldProbe& probe, const SampledTexture& texture,
                                      const volume::RayOffsets& texels, const RayCounting& count) {
  probe.show_instead(texture, texels.width, texels.height, texels.steps);
  auto counted = count();
  auto* all = std::get_if<std::vector<CountedRay>>(&counted);
  return all != nullptr ? std::move(*all) : std::vector<CountedRay>{};
}

/// Determines how `texture` moves rays; null if it does not. `own` were counted under its own numbers.
std::optional<JitterFinding> jitter_by(const GlContext& context, FieldProbe& probe,
                                       const SampledTexture& texture, const RayCounting& count,
                                       const std::vector<CountedRay>& own,
                                       std::span<const volume::Vec3> spaces) {
  constexpr double rounding = 0.6;  // half a step, plus the errors of the fit and of the texture's precision
  constexpr double fewest_samples = 4;  // some programs take one on rays too short for any
  const auto tile = tile_of(*context.gl, texture);
  if (!tile) return std::nullopt;
  volume::RayOffsets shown{tile->width, tile->height, std::vector<float>(tile->texels(), 0.0F)};
  std::vector<CountedRay> zeros = counted_under(probe, texture, shown, count);
  const auto fits = fit_steps(zeros, spaces);
  const bool alike = !fits.empty() && std::all_of(fits.begin(), fits.end(), [](const StepFit& fit) {
    return fit.unexplained <= most_unexplained;
  });
  if (!alike) return std::nullopt;
  std::erase_if(zeros, [](const CountedRay& ray) { return ray.samples < fewest_samples; });
  const auto strayed = [&](double tolerance, const auto& difference) {
    const auto off = std::count_if(zeros.begin(), zeros.end(), [&](const CountedRay& ray) {
      return std::abs(difference(ray)) > tolerance;
    });
    return double(off) / double(std::max(zeros.size(), std::size_t(1)));
  };

  std::fill(shown.steps.begin(), shown.steps.end(), 1.0F);
  const Counts ones(counted_under(probe, texture, shown, count));
  double lost = 0;
  for (const CountedRay& ray : zeros) lost += ray.samples - ones.at(ray);
  double steps = lost / double(std::max(zeros.size(), std::size_t(1)));
  if (std::abs(steps - std::round(steps)) < 0.02) steps = std::round(steps);
  if (steps == 0) return std::nullopt;

  std::mt19937 random(1);
  for (float& texel : shown.steps) texel = float(random() & 1U);
  const Counts mixed(counted_under(probe, texture, shown, count));
  const double by_another_texel = strayed(0, [&](const CountedRay& ray) {
    return mixed.at(ray) - (shown.at(ray.x, ray.y) > 0 ? ones.at(ray) : ray.samples);
  });
  if (by_another_texel > most_strayed) return std::nullopt;

  const auto numbers = noise_in(context, texture);
  if (!numbers) return std::nullopt;
  const Counts counted(own);
  const StepFit& fit = fits.front();
  const volume::RaySteps rule = rules_of(fit).front();
  const double by_another_number = strayed(rounding, [&](const CountedRay& ray) {
    return counted.at(ray) - (steps_of_way(rule, ray.way) + fit.offset - steps * numbers->at(ray.x, ray.y));
  });
  if (by_another_number > most_strayed) return std::nullopt;
  return JitterFinding{{texture.sampler_location, steps}, fits};
}

/// Returns by how many steps the samples lie further from the rays' beginnings in `later` than in `sooner`:
/// this many fewer lie in front of a plane.
double steps_between(const std::vector<SplitRays>& sooner, const std::vector<SplitRays>& later,
                     const RaysThroughBox& rays) {
  double lost = 0;
  std::size_t told = 0;
  for (std::size_t s = 0; s < sooner.size(); ++s) {
    const std::size_t axis = sooner[s].field.axis;
    for (std::size_t i = 0; i < sooner[s].rays.size(); ++i) {
      const SplitRay& ray = sooner[s].rays[i];
      const auto way = rays.way(ray.place[0], ray.place[1]);
      // Close to either end of a ray, there are no samples left to lose.
      if (!way || ray.before < 2 || ray.samples - ray.before < 2) continue;
      const double fewer = ray.before - later[s].rays[i].before;
      lost += (*way)[axis] > 0 ? fewer : -fewer;
      ++told;
    }
  }
  return lost / double(std::max(told, std::size_t(1)));
}

bool same_rays(const std::vector<SplitRays>& a, const std::vector<SplitRays>& b) {
  const auto same = [](const SplitRay& one, const SplitRay& other) {
    return one.place == other.place && one.samples == other.samples;
  };
  return std::ranges::equal(a, b, [&](const SplitRays& one, const SplitRays& other) {
    return std::ranges::equal(one.rays, other.rays, same);
  });
}

std::optional<Jitter> moving_jitter_by(const GlContext& context, FieldProbe& probe,
                                       const SampledTexture& texture, const RaySplitting& split,
                                       const RaysThroughBox& rays, const std::vector<volume::RaySteps>& rules) {
  const auto numbers = noise_in(context, texture);
  if (!numbers) return std::nullopt;
  volume::RayOffsets shown = *numbers;
  const auto split_under = [&](const auto& texel) {
    std::ranges::generate(shown.steps, texel);
    probe.show_instead(texture, shown.width, shown.height, shown.steps);
    return split();
  };
  const auto zeros = split_under([] { return 0.0F; });
  const auto rule = std::ranges::find_if(rules, [&](const volume::RaySteps& steps) {
    return misplaced_part(zeros, rays, steps).value_or(0) <= most_misplaced;
  });
  if (zeros.empty() || rule == rules.end()) return std::nullopt;
  const auto ones = split_under([] { return 1.0F; });
  if (!same_rays(zeros, ones)) return std::nullopt;
  Jitter jitter{texture.sampler_location, steps_between(zeros, ones, rays), true};
  if (std::abs(jitter.steps_per_unit - std::round(jitter.steps_per_unit)) < 0.02)
    jitter.steps_per_unit = std::round(jitter.steps_per_unit);
  if (!(jitter.steps_per_unit > 0)) return std::nullopt;

  std::mt19937 random(1);
  const auto mixed = split_under([&] { return float(random() & 1U); });
  const auto explained_by = [&](const std::vector<SplitRays>& seen, const volume::RayOffsets& texels) {
    volume::RaySteps moved = *rule;
    moved.offsets = scaled(texels, jitter);
    return same_rays(zeros, seen) && misplaced_part(seen, rays, moved).value_or(0) <= most_misplaced;
  };
  if (!explained_by(mixed, shown)) return std::nullopt;
  probe.show_own(texture);
  if (!explained_by(split(), *numbers)) return std::nullopt;
  return jitter;
}

}  // namespace

std::optional<volume::RayOffsets> noise_in(const GlContext& context, const SampledTexture& texture) {
  const DispatchTable& gl = *context.gl;
  if (texture.target != GL_TEXTURE_2D) return std::nullopt;
  SavedState saved(context);
  saved.borrow_texture(GL_TEXTURE_2D, texture.unit);
  gl.BindTexture(GL_TEXTURE_2D, texture.texture);
  const auto tile = tile_of(gl, texture);
  if (!tile) return std::nullopt;
  volume::RayOffsets numbers{tile->width, tile->height, std::vector<float>(tile->texels())};
  gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, numbers.steps.data());
  return numbers;
}

std::optional<JitterFinding> find_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RayCounting& count, const std::vector<CountedRay>& own,
                                         std::span<const volume::Vec3> spaces) {
  for (const SampledTexture& texture : run.pipeline().others) {
    auto finding = jitter_by(context, probe, texture, count, own, spaces);
    if (finding && hold_still(run, probe, finding->jitter)) return finding;
    probe.show_own(texture);
  }
  return std::nullopt;
}

std::optional<Jitter> find_moving_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RaySplitting& split, const RaysThroughBox& rays,
                                         const std::vector<volume::RaySteps>& rules) {
  for (const SampledTexture& texture : run.pipeline().others) {
    const auto jitter = moving_jitter_by(context, probe, texture, split, rays, rules);
    probe.show_own(texture);
    if (jitter) return jitter;
  }
  return std::nullopt;
}

bool begin_rays_at(const Run& run, FieldProbe& probe, const Jitter& jitter, float number) {
  const SampledTexture* const texture = sampled_at(run, jitter.sampler_location);
  if (texture == nullptr || texture->target != GL_TEXTURE_2D) return false;
  probe.show_instead(*texture, 1, 1, {&number, 1});
  return true;
}

bool hold_still(const Run& run, FieldProbe& probe, const Jitter& jitter) {
  return begin_rays_at(run, probe, jitter, 0);
}

bool show_own_noise(const Run& run, FieldProbe& probe, const Jitter& jitter) {
  const SampledTexture* const texture = sampled_at(run, jitter.sampler_location);
  if (texture == nullptr) return false;
  probe.show_own(*texture);
  return true;
}

std::optional<volume::RayOffsets> ray_offsets(const GlContext& context, const Run& run, const Jitter& jitter) {
  const SampledTexture* const texture = sampled_at(run, jitter.sampler_location);
  auto numbers = texture != nullptr ? noise_in(context, *texture) : std::nullopt;
  if (!numbers) return std::nullopt;
  return scaled(*std::move(numbers), jitter);
}

}  // namespace understudy::spu
