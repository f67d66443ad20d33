// SPDX-License-Identifier: Apache-2.0
// One setting of one scene: its time, and its error against the integral.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"

namespace understudy::launcher::study {

enum class Scheme : std::uint8_t {
  post_classified,
  pre_integrated,
  adaptive,
  eight_bit_slices,
  // What other programs show and take, see other_programs.h.
  bare_viewer,
  vtk_gpu,
  vtk_fixed_point,
};
inline constexpr std::array all_schemes{Scheme::post_classified,  Scheme::pre_integrated, Scheme::adaptive,
                                        Scheme::eight_bit_slices, Scheme::bare_viewer,    Scheme::vtk_gpu,
                                        Scheme::vtk_fixed_point};
const char* name_of(Scheme scheme);
bool is_other_program(Scheme scheme);

struct Setting {
  Scheme scheme = Scheme::post_classified;
  double step = 1;  ///< in voxels
  double termination = 5e-6;

  bool operator==(const Setting&) const = default;
};

/// All settings of a study, those of a quick one first; those of other programs last.
std::vector<Setting> settings(bool quick);

struct Difference {
  double max = 0;
  double rms = 0;
  double colour = 0;  ///< RMS without opacity, which not every program's image tells
};
Difference difference(const Scene::Rays& a, const Scene::Rays& b);

struct Point {
  Setting setting;
  Difference error;
  double time_ms = 0;  ///< median; 0 where no time was taken (slices of eight bits are only emulated)
  double ns_per_ray = 0;
  std::uint64_t samples_taken = 0;
  std::uint64_t samples = 0;
  bool front = false;  ///< no setting of ours is both faster and nearer to the integral
};

/// Renders `repetitions` times. `rays` gets what was compared.
Point measure(Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays);

void mark_front(std::span<Point> points);

/// How settings of ours compare with what another program measured: the ratios of time at its error, and of
/// error (of colour) at its time, by interpolation in logarithms along our front. `at_least` where the front
/// ends before: our cheapest setting is more exact already, or our most exact one takes less time.
struct Ratio {
  double value = 0;
  bool at_least = false;
};
struct Advantage {
  std::optional<Ratio> time;   ///< theirs over ours; nothing: no setting is as exact
  std::optional<Ratio> error;  ///< theirs over ours; nothing: no setting is as fast
};
/// Nothing where the other program has not been measured.
std::optional<Advantage> advantage_over(std::span<const Point> points, Scheme other);

/// The slope of log RMS over log step, by least squares, of all points of a scheme with the finest
/// termination; nothing for less than three.
std::optional<double> observed_order(std::span<const Point> points, Scheme scheme);

}  // namespace understudy::launcher::study
