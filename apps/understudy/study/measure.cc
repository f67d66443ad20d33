// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include "volume/request.h"

namespace understudy::launcher::study {
namespace {

constexpr double finest_termination = 5e-6;
/// Tolerance for steps of one voxel; for other steps it scales with the square of their
/// length, as their error does.
constexpr double adaptive_tolerance = 4e-3;

/// Returns a quantile of values in ascending order.
double quantile(std::span<const double> sorted, double share) {
  return sorted[std::min(std::size_t(share * double(sorted.size())), sorted.size() - 1)];
}

/// Returns the 95 % interval of the RMS over rays, given each ray's sum of four squares.
std::array<double, 2> bootstrapped_rms(std::span<const double> squares) {
  constexpr int resamplings = 400;
  std::minstd_rand random;
  std::uniform_int_distribution<std::size_t> any(0, squares.size() - 1);
  std::vector<double> found;
  for (int i = 0; i < resamplings; ++i) {
    double sum = 0;
    for (std::size_t ray = 0; ray < squares.size(); ++ray) sum += squares[any(random)];
    found.push_back(std::sqrt(sum / (4 * double(squares.size()))));
  }
  std::ranges::sort(found);
  return {quantile(found, 0.025), quantile(found, 0.975)};
}

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

Difference difference(std::span<const std::array<double, 4>> a, std::span<const std::array<double, 4>> b) {
  if (a.size() != b.size()) throw std::invalid_argument("the numbers of compared rays differ");
  Difference result;
  if (a.empty()) return result;
  std::vector<double> squares, greatest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double square = 0, most = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double d = std::abs(a[i][k] - b[i][k]);
      most = std::max(most, d);
      square += d * d;
      if (k < 3) result.colour += d * d;
    }
    squares.push_back(square);
    greatest.push_back(most);
  }
  const auto rays = double(a.size());
  result.rms = std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / (4 * rays));
  result.colour = std::sqrt(result.colour / (3 * rays));
  result.interval = bootstrapped_rms(squares);
  std::ranges::sort(greatest);
  result.max = greatest.back();
  result.quantiles = {quantile(greatest, 0.5), quantile(greatest, 0.95), quantile(greatest, 0.99)};
  return result;
}

Measurement::Measurement(const Scene& scene, const Setting& setting)
    : scene_(scene), setting_(setting), caster_(scene.store()), image_({0, 0, scene.edge(), scene.edge()}) {
  for (const volume::OrbitCamera& camera : Scene::cameras()) {
    requests_.push_back(scene.request(setting.step, method_of(setting.scheme), setting.termination, camera));
    requests_.back().tolerance = float(adaptive_tolerance * setting.step * setting.step);
  }
  for (std::size_t camera = 0; camera < requests_.size(); ++camera) {
    rendered(camera);
    const Scene::Rays compared = scene.compared(image_);
    rays_.insert(rays_.end(), compared.begin(), compared.end());
    if (setting.scheme == Scheme::post_classified)
      bound_ = std::max(bound_, scene.greatest_bound(requests_[camera], setting.step));
  }
}

double Measurement::rendered(std::size_t camera) {
  volume::FrameCounts counts;
  const auto start = std::chrono::steady_clock::now();
  caster_.render(requests_[camera], image_, counts);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  if (rays_.size() < scene_.exact().size()) counts_ += counts;
  return time.count();
}

void Measurement::render() {
  const std::size_t camera = times_.size() % requests_.size();
  rendered(camera);
  times_.push_back(rendered(camera));
}

Point Measurement::point() const {
  Point point{setting_};
  point.error = difference(rays_, scene_.exact());
  point.bound = bound_;
  const auto images = double(requests_.size());
  point.samples = counts_.samples / requests_.size();
  point.samples_taken = counts_.samples_taken / requests_.size();
  if (times_.empty()) return point;
  std::vector<double> times = times_;
  std::ranges::sort(times);
  point.time_ms = quantile(times, 0.5);
  point.quartiles = {quantile(times, 0.25), quantile(times, 0.75)};
  point.ns_per_ray = 1e6 * point.time_ms * images / double(std::max<std::uint64_t>(counts_.rays, 1));
  return point;
}

Point measure(const Scene& scene, const Setting& setting, int repetitions, Scene::Rays& rays) {
  if (setting.scheme == Scheme::eight_bit_slices) {
    Point point{setting};
    rays = scene.in_eight_bits(setting.step);
    point.error = difference(rays, scene.exact());
    return point;
  }
  Measurement measurement(scene, setting);
  for (int i = 0; i < repetitions; ++i) measurement.render();
  rays = measurement.rays();
  return measurement.point();
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

/// Returns the Pareto front of our settings, fastest first; each is more exact than those before it.
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

namespace {

using LogPoint = std::array<double, 2>;  // of the step, and of the error

double fitted_slope(std::span<const LogPoint> logs) {
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

bool is_straight(std::span<const LogPoint> logs, double slope) {
  constexpr double most_apart = 0.25;
  for (std::size_t i = 1; i < logs.size(); ++i) {
    const double between = (logs[i][1] - logs[i - 1][1]) / (logs[i][0] - logs[i - 1][0]);
    if (!(std::abs(between - slope) <= most_apart)) return false;
  }
  return true;
}

}  // namespace

std::optional<ObservedOrder> observed_order(std::span<const Point> points, Scheme scheme) {
  constexpr double float_rounding = 1e-6;
  constexpr std::size_t fewest_steps = 3;
  std::vector<LogPoint> logs;
  for (const Point& point : points) {
    const Setting& setting = point.setting;
    if (setting.scheme == scheme && setting.termination == finest_termination &&
        point.error.rms > float_rounding)
      logs.push_back({std::log(setting.step), std::log(point.error.rms)});
  }
  std::ranges::sort(logs);
  for (std::size_t length = logs.size(); length >= fewest_steps; --length) {
    for (std::size_t first = 0; first + length <= logs.size(); ++first) {
      const std::span range = std::span(logs).subspan(first, length);
      const double slope = fitted_slope(range);
      if (is_straight(range, slope))
        return ObservedOrder{slope, {std::exp(range.front()[0]), std::exp(range.back()[0])}};
    }
  }
  return std::nullopt;
}

}  // namespace understudy::launcher::study
