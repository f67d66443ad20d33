// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

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
      return "slices in 8 bits (emulated)";
    case Scheme::bare_viewer:
      return "the bare viewer's slices";
    case Scheme::vtk_gpu:
      return "VTK's GPU mapper";
    case Scheme::vtk_fixed_point:
      break;
  }
  return "VTK's fixed-point mapper";
}

bool is_other_program(Scheme scheme) {
  return scheme == Scheme::bare_viewer || scheme == Scheme::vtk_gpu || scheme == Scheme::vtk_fixed_point;
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
  for (const Scheme scheme : {Scheme::bare_viewer, Scheme::vtk_gpu, Scheme::vtk_fixed_point})
    all.push_back({scheme, 1, 0});
  return all;
}

Difference difference(const Scene::Rays& a, const Scene::Rays& b) {
  Difference result;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const double d = std::abs(a[i][k] - b[i][k]);
      result.max = std::max(result.max, d);
      result.rms += d * d;
      if (k < 3) result.colour += d * d;
    }
  const auto rays = double(std::max<std::size_t>(a.size(), 1));
  result.rms = std::sqrt(result.rms / (4 * rays));
  result.colour = std::sqrt(result.colour / (3 * rays));
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
  volume::Image image(request.window);
  volume::RayCaster caster(scene.store());
  std::vector<double> times;
  // The first image prepares what depends on the table alone, which a viewer pays once a table.
  for (int i = 0; i <= repetitions; ++i) {
    volume::FrameCounts counts;
    const auto start = std::chrono::steady_clock::now();
    caster.render(request, image, counts);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (i > 0) times.push_back(time.count());
    point.samples = counts.samples;
    point.samples_taken = counts.samples_taken;
    point.ns_per_ray = 1e6 / double(std::max<std::uint64_t>(counts.rays, 1));
  }
  std::ranges::nth_element(times, times.begin() + std::ptrdiff_t(times.size() / 2));
  point.time_ms = times[times.size() / 2];
  point.ns_per_ray *= point.time_ms;
  rays = scene.compared(image);
  point.error = difference(rays, scene.exact());
  return point;
}

void mark_front(std::span<Point> points) {
  for (Point& point : points) {
    const bool beaten = std::ranges::any_of(points, [&](const Point& other) {
      return other.time_ms > 0 && !is_other_program(other.setting.scheme) && other.time_ms <= point.time_ms &&
             other.error.rms <= point.error.rms &&
             (other.time_ms < point.time_ms || other.error.rms < point.error.rms);
    });
    point.front = point.time_ms > 0 && !is_other_program(point.setting.scheme) && !beaten;
  }
}

namespace {

struct TimedError {
  double time, error;
};

/// Ours, the fastest first; each is more exact than those before it.
std::vector<TimedError> front_of(std::span<const Point> points) {
  std::vector<TimedError> front;
  for (const Point& point : points)
    if (point.time_ms > 0 && !is_other_program(point.setting.scheme) && point.error.colour > 0)
      front.push_back({point.time_ms, point.error.colour});
  std::ranges::sort(front, {}, &TimedError::time);
  double best = std::numeric_limits<double>::infinity();
  std::erase_if(front, [&](const TimedError& one) {
    const bool beaten = one.error >= best;
    best = std::min(best, one.error);
    return beaten;
  });
  return front;
}

double on_the_way(double x, double x0, double x1, double y0, double y1) {
  return y0 * std::pow(y1 / y0, std::log(x / x0) / std::log(x1 / x0));
}

}  // namespace

std::optional<Advantage> advantage_over(std::span<const Point> points, Scheme other) {
  const auto theirs = std::ranges::find_if(
      points, [&](const Point& point) { return point.setting.scheme == other && point.time_ms > 0; });
  const std::vector<TimedError> front = front_of(points);
  if (theirs == points.end() || front.empty()) return std::nullopt;
  const double time = theirs->time_ms, error = theirs->error.colour;
  Advantage advantage;
  const TimedError fastest = front.front(), finest = front.back();
  if (error >= fastest.error) advantage.time = {time / fastest.time, true};
  if (time >= finest.time) advantage.error = {error / finest.error, true};
  for (std::size_t i = 1; i < front.size(); ++i) {
    const TimedError &a = front[i - 1], &b = front[i];
    if (error < a.error && error >= b.error)
      advantage.time = {time / on_the_way(error, a.error, b.error, a.time, b.time), false};
    if (time >= a.time && time < b.time)
      advantage.error = {error / on_the_way(time, a.time, b.time, a.error, b.error), false};
  }
  return advantage;
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
