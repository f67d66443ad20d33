#include "apps/understudy/study/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace understudy::launcher::study {
namespace {

constexpr double finest_termination = 5e-6;
/// Of steps one voxel long; that of others falls with the square of their length, as their error does.
constexpr double adaptive_tolerance = 4e-3;

volume::Method method_of(Scheme scheme) {
  return scheme == Scheme::pre_integrated ? volume::Method::pre_integrated
         : scheme == Scheme::adaptive     ? volume::Method::adaptive
                                          : volume::Method::post_classified;
}

}  // namespace

const char* name_of(Scheme scheme) {
  switch (scheme) {
    case Scheme::post_classified:
      return "post-classified";
    case Scheme::pre_integrated:
      return "pre-integrated";
    case Scheme::adaptive:
      return "adaptive";
    case Scheme::eight_bit_slices:
      break;
  }
  return "slices in 8 bits (emulated)";
}

std::vector<Setting> settings(bool quick) {
  std::vector<Setting> all;
  std::vector<double> steps{4, 2, 1, 0.5, 0.25};
  if (!quick) steps.insert(steps.end(), {8, 0.125});
  for (const Scheme scheme : {Scheme::post_classified, Scheme::pre_integrated, Scheme::adaptive}) {
    for (const double step : steps) all.push_back({scheme, step, finest_termination});
    for (const double step : {1.0, 0.5})
      for (const double termination : {0.05, 0.01, 0.001}) all.push_back({scheme, step, termination});
  }
  for (const double step : {1.0, 0.5}) all.push_back({Scheme::eight_bit_slices, step, 0});
  return all;
}

Difference difference(const Scene::Rays& a, const Scene::Rays& b) {
  Difference result;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const double d = std::abs(a[i][k] - b[i][k]);
      result.max = std::max(result.max, d);
      result.rms += d * d;
    }
  result.rms = std::sqrt(result.rms / double(std::max<std::size_t>(4 * a.size(), 1)));
  return result;
}

Point measure(Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays) {
  Point point{setting};
  if (setting.scheme == Scheme::eight_bit_slices) {
    rays = scene.in_eight_bits(setting.step);
    point.error = difference(rays, scene.exact());
    return point;
  }
  volume::RenderRequest request = scene.request(setting.step, method_of(setting.scheme), setting.termination);
  request.tolerance = float(adaptive_tolerance * setting.step * setting.step);
  volume::Image picture(request.window);
  volume::RayCaster caster(scene.store());
  std::vector<double> times;
  // The first picture prepares what depends on the table alone, which a viewer pays once a table.
  for (int i = 0; i <= repetitions; ++i) {
    volume::FrameCounts counts;
    const auto start = std::chrono::steady_clock::now();
    caster.render(request, picture, counts);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (i > 0) times.push_back(time.count());
    point.samples = counts.samples;
    point.samples_taken = counts.samples_taken;
    point.ns_per_ray = 1e6 / double(std::max<std::uint64_t>(counts.rays, 1));
  }
  std::ranges::nth_element(times, times.begin() + std::ptrdiff_t(times.size() / 2));
  point.time_ms = times[times.size() / 2];
  point.ns_per_ray *= point.time_ms;
  rays = scene.compared(picture);
  point.error = difference(rays, scene.exact());
  return point;
}

void mark_front(std::span<Point> points) {
  for (Point& point : points) {
    const bool beaten = std::ranges::any_of(points, [&](const Point& other) {
      return other.time_ms > 0 && other.time_ms <= point.time_ms && other.error.rms <= point.error.rms &&
             (other.time_ms < point.time_ms || other.error.rms < point.error.rms);
    });
    point.front = point.time_ms > 0 && !beaten;
  }
}

std::optional<double> observed_order(std::span<const Point> points, Scheme scheme) {
  std::vector<std::array<double, 2>> logs;
  for (const Point& point : points)
    if (point.setting.scheme == scheme && point.setting.termination == finest_termination &&
        point.error.rms > 0)
      logs.push_back({std::log(point.setting.step), std::log(point.error.rms)});
  if (logs.size() < 3) return std::nullopt;
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (const auto& [x, y] : logs) {
    mean_x += x / double(logs.size());
    mean_y += y / double(logs.size());
  }
  for (const auto& [x, y] : logs) {
    xx += (x - mean_x) * (x - mean_x);
    xy += (x - mean_x) * (y - mean_y);
  }
  return xy / xx;
}

}  // namespace understudy::launcher::study
