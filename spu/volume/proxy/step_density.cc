// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/step_density.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace understudy::spu {
namespace {

/// How close the sampled stretches are to whole numbers of steps: 1 is exactly, 0 not at all.
double wholeness(std::span<const SampledWay> ways, double density) {
  double sum = 0;
  for (const SampledWay& way : ways) sum += std::cos(2 * M_PI * density * way.sampled);
  return sum / double(ways.size());
}

/// The wholeness of some of the paths for a sequence of densities, each `apart` from the last. From one to the
/// next, each term turns by a constant angle, which takes no cosine: there are up to 80,000 densities.
class WholenessScan {
 public:
  WholenessScan(std::span<const SampledWay> ways, double density, double apart) {
    constexpr std::size_t most_ways = 64;
    const std::size_t every = (ways.size() + most_ways - 1) / most_ways;
    for (std::size_t i = 0; i < ways.size(); i += every) {
      const double now = 2 * M_PI * density * ways[i].sampled;
      const double turn = 2 * M_PI * apart * ways[i].sampled;
      turning_.push_back({std::cos(now), std::sin(now), std::cos(turn), std::sin(turn)});
    }
  }

  double next() {
    double sum = 0;
    for (Turning& way : turning_) {
      sum += way.x;
      const double x = way.x * way.cosine - way.y * way.sine;
      way.y = way.x * way.sine + way.y * way.cosine;
      way.x = x;
    }
    return sum / double(turning_.size());
  }

 private:
  struct Turning {
    double x, y;          ///< of a point on the unit circle
    double cosine, sine;  ///< of the angle to the next density
  };
  std::vector<Turning> turning_;
};

}  // namespace

std::optional<double> step_density(std::span<const SampledWay> ways) {
  constexpr double whole_enough = 0.7;
  constexpr double by_chance = 0.3;    // by which the scan's few paths may be less whole than all are
  constexpr double most_steps = 2000;  // colours do not resolve more
  std::vector<double> behind;
  double longest = 0;
  for (const SampledWay& way : ways) {
    behind.push_back(way.behind);
    longest = std::max(longest, way.whole);
  }
  if (behind.empty()) return std::nullopt;
  // Rays end anywhere within their last step: the path behind it is at most one step.
  const auto widest = behind.begin() + std::ptrdiff_t(0.95 * double(behind.size()));
  std::nth_element(behind.begin(), widest, behind.end());
  if (!(*widest * most_steps > longest)) return std::nullopt;
  const double finest = 0.02 / longest;
  const double lowest = 0.6 / *widest;
  const auto tried = std::size_t(0.8 / *widest / finest);
  WholenessScan scan(ways, lowest, finest);
  double best = 0;
  double most = whole_enough;
  for (std::size_t i = 0; i < tried; ++i) {
    if (scan.next() < most - by_chance) continue;
    const double density = lowest + double(i) * finest;
    const double whole = wholeness(ways, density);
    if (whole <= most) continue;
    most = whole;
    best = density;
  }
  return best > 0 ? std::optional(best) : std::nullopt;
}

}  // namespace understudy::spu
