// SPDX-License-Identifier: Apache-2.0
// Measures one setting of one scene: its time, and its error against the integral.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::launcher::study {

enum class Scheme : std::uint8_t {
  post_classified,
  pre_integrated,
  adaptive,
  eight_bit_slices,
  // Measured with other programs, see other_programs.h.
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

/// Returns all settings of a study: those of a quick one first, those of other programs last.
std::vector<Setting> settings(bool quick);

struct Difference {
  double max = 0;
  double rms = 0;
  double colour = 0;                 ///< RMS without opacity, which some programs' images lack
  std::array<double, 2> interval{};  ///< 95 % interval of the RMS, by bootstrap over rays (Efron 1979)
  /// Quantiles of the rays' greatest differences: 50 %, 95 % and 99 %.
  std::array<double, 3> quantiles{};
};
/// Throws std::invalid_argument if `a` and `b` differ in size.
Difference difference(std::span<const std::array<double, 4>> a, std::span<const std::array<double, 4>> b);

struct Point {
  Setting setting;
  Difference error;
  double time_ms = 0;  ///< median; 0 if no time was measured (slices of eight bits are only emulated)
  double ns_per_ray = 0;
  std::uint64_t samples_taken = 0;
  std::uint64_t samples = 0;
  bool front = false;                 ///< none of our settings is both faster and nearer to the integral
  std::array<double, 2> quartiles{};  ///< quartiles of the times, in ms
  /// The greatest certified bound of a ray's error (volume/error_bound); 0: the scheme has none.
  double bound = 0;
};

/// Measures one of our settings on all cameras. For comparable times, measurements of several
/// settings must take turns.
class Measurement {
 public:
  /// Renders the image of each camera once.
  Measurement(const Scene& scene, const Setting& setting);

  /// Renders the next camera's image twice and records the second time: the first image prepares what depends
  /// on the transfer function alone, which a viewer pays once per transfer function.
  void render();

  /// The rays that were compared.
  const Scene::Rays& rays() const { return rays_; }
  Point point() const;

 private:
  double rendered(std::size_t camera);

  const Scene& scene_;
  Setting setting_;
  std::vector<volume::RenderRequest> requests_;  ///< one per camera
  volume::RayCaster caster_;
  volume::Image image_;
  volume::FrameCounts counts_;  ///< sum over all cameras
  Scene::Rays rays_;
  double bound_ = 0;
  std::vector<double> times_;
};

/// Measures a setting with `repetitions` times, and returns the compared rays in `rays`. Slices
/// of eight bits are emulated.
Point measure(const Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays);

void mark_front(std::span<Point> points);

/// Ratio of another program's measurement to ours: of time at equal error, or of error (of colour) at equal
/// time, by logarithmic interpolation along our Pareto front. `at_least`: the front ends before, because our
/// cheapest setting is already more exact, or our most exact one takes less time.
struct Ratio {
  double value = 0;
  bool at_least = false;
};
struct Advantage {
  std::optional<Ratio> time;   ///< theirs / ours; empty: none of our settings is as exact
  std::optional<Ratio> error;  ///< theirs / ours; empty: none of our settings is as fast
};
/// Returns nothing if the other program has not been measured.
std::optional<Advantage> advantage_over(std::span<const Point> points, Scheme other);

/// Observed order of accuracy: the slope of log RMS over log step.
struct ObservedOrder {
  double slope = 0;
  std::array<double, 2> steps{};  ///< the range of the fit, finest step first
};
/// Fits the order by least squares over the asymptotic range of a scheme's points with the finest termination.
/// This range has the most neighbouring steps, at least three, such that the slope between any two neighbours
/// differs from that of the fit by at most a quarter; of two such ranges, the finer one. Errors at the level of
/// float rounding are excluded. Returns nothing if there is no such range.
std::optional<ObservedOrder> observed_order(std::span<const Point> points, Scheme scheme);

}  // namespace understudy::launcher::study
