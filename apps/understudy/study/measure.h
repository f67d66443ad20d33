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
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"

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
  double colour = 0;                 ///< RMS without opacity, which not every program's image tells
  std::array<double, 2> interval{};  ///< of 95 %, of the RMS: by bootstrap over rays (Efron 1979)
  /// Of the rays' greatest differences: what half of them, 95 % and 99 % stay below.
  std::array<double, 3> quantiles{};
};
/// Throws std::invalid_argument where there are not as many of one as of the other.
Difference difference(std::span<const std::array<double, 4>> a, std::span<const std::array<double, 4>> b);

struct Point {
  Setting setting;
  Difference error;
  double time_ms = 0;  ///< median; 0 where no time was taken (slices of eight bits are only emulated)
  double ns_per_ray = 0;
  std::uint64_t samples_taken = 0;
  std::uint64_t samples = 0;
  bool front = false;                 ///< no setting of ours is both faster and nearer to the integral
  std::array<double, 2> quartiles{};  ///< of the times, in ms
  /// The greatest certified bound of a ray's error (volume/error_bound); 0: there is none for the scheme.
  double bound = 0;
};

/// One setting of ours on all cameras. Times of several settings are comparable where these take turns.
class Measurement {
 public:
  /// Renders each camera's image once.
  Measurement(const Scene& scene, const Setting& setting);

  /// Renders the next camera's image twice, and notes the second time: the first image prepares what depends on
  /// the table alone, which a viewer pays once a table.
  void render();

  /// What was compared.
  const Scene::Rays& rays() const { return rays_; }
  Point point() const;

 private:
  double rendered(std::size_t camera);

  const Scene& scene_;
  Setting setting_;
  std::vector<volume::RenderRequest> requests_;  ///< by camera
  volume::RayCaster caster_;
  volume::Image image_;
  volume::FrameCounts counts_;  ///< of all cameras
  Scene::Rays rays_;
  double bound_ = 0;
  std::vector<double> times_;
};

/// With so many times. `rays` gets what was compared. Slices of eight bits are emulated.
Point measure(const Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays);

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

/// The slope of log RMS over log step.
struct ObservedOrder {
  double slope = 0;
  std::array<double, 2> steps{};  ///< the range that it was fitted over, the finest first
};
/// By least squares over the asymptotic range of a scheme's points with the finest termination: the most
/// neighbouring steps, at least three, between any two of which the slope differs from the fit's by no more
/// than a quarter; of two such ranges the finer. Errors that float rounding makes are left out. Nothing where
/// there is no such range.
std::optional<ObservedOrder> observed_order(std::span<const Point> points, Scheme scheme);

}  // namespace understudy::launcher::study
