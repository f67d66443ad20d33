// One setting of one scene: its time, and its error against the integral.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"

namespace understudy::launcher::study {

enum class Scheme : std::uint8_t { post_classified, pre_integrated, adaptive, eight_bit_slices };
const char* name_of(Scheme scheme);

struct Setting {
  Scheme scheme = Scheme::post_classified;
  double step = 1;  ///< in voxels
  double termination = 5e-6;

  bool operator==(const Setting&) const = default;
};

/// All settings of a study, those of a quick one first.
std::vector<Setting> settings(bool quick);

struct Difference {
  double max = 0;
  double rms = 0;
};
Difference difference(const Scene::Rays& a, const Scene::Rays& b);

struct Point {
  Setting setting;
  Difference error;
  double time_ms = 0;  ///< median; 0 where no time was taken (slices of eight bits are only emulated)
  double ns_per_ray = 0;
  std::uint64_t samples_taken = 0;
  std::uint64_t samples = 0;
  bool front = false;  ///< nothing measured is both faster and nearer to the integral
};

/// Renders `repetitions` times. `rays` gets what was compared.
Point measure(Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays);

void mark_front(std::span<Point> points);

/// The slope of log RMS over log step, by least squares, of all points of a scheme with the finest
/// termination; nothing for less than three.
std::optional<double> observed_order(std::span<const Point> points, Scheme scheme);

}  // namespace understudy::launcher::study
