// understudy-bench-scaling: what a frame would cost on 1 to 1,024 ranks, on paper. The partition, the
// footprints and the exchange's messages are those that the nodes would really use; only time is modelled: so
// many nanoseconds a sample, so many a message, a byte and a blended pixel. Prints one JSON object a line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "compositor/exchange/cost.h"
#include "compositor/exchange/schedule.h"
#include "volume/footprint.h"
#include "volume/kd_tree.h"
#include "volume/matrix.h"

namespace {

using namespace understudy;

struct Settings {
  int side = 512;     ///< voxels, along each axis
  bool weak = false;  ///< `side` is for one rank; the volume grows with their number
  int pixels = 1024;
  int most_ranks = 1024;
  double ns_per_sample = 2;
  double latency = 5e-6;
  double gigabits = 100;
  double ns_per_pixel = 2;
};

volume::VolumeDescription cube(int side) {
  volume::VolumeDescription description;
  description.size = {side, side, side};
  description.stored = {{0, 0, 0}, description.size};
  return description;
}

/// The eye two edges away, 30 degrees around and 25 above, with an opening of 40 degrees; in units of the edge.
volume::RenderRequest view(int pixels) {
  constexpr double degree = std::numbers::pi / 180;
  const volume::Vec3 back{std::sin(30 * degree) * std::cos(25 * degree), std::sin(25 * degree),
                          std::cos(30 * degree) * std::cos(25 * degree)};
  const volume::Vec3 right{std::cos(30 * degree), 0, -std::sin(30 * degree)};
  const volume::Vec3 up = volume::cross(back, right);
  const double near = 0.5, far = 4, f = 1 / std::tan(20 * degree);
  const volume::Matrix4 projection{
      f, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), 2 * far * near / (near - far), 0, 0, -1, 0};
  const volume::Matrix4 camera{right[0], right[1], right[2], 0,  up[0], up[1], up[2], 0,
                               back[0],  back[1],  back[2],  -2, 0,     0,     0,     1};
  const volume::Matrix4 centred{1, 0, 0, -0.5, 0, 1, 0, -0.5, 0, 0, 1, -0.5, 0, 0, 0, 1};
  volume::RenderRequest request;
  request.texture_to_clip = volume::multiply(projection, volume::multiply(camera, centred));
  request.viewport = request.window = {0, 0, pixels, pixels};
  return request;
}

struct Ray {
  volume::Vec3 origin{};
  volume::Vec3 direction{};  ///< of length one
};

Ray ray_through(const volume::Matrix4& clip_to_texture, double x, double y) {
  const auto point = [&](double z) {
    const volume::Vec4 p = volume::transform_point(clip_to_texture, {x, y, z});
    return volume::Vec3{p[0] / p[3], p[1] / p[3], p[2] / p[3]};
  };
  const volume::Vec3 near = point(-1);
  const volume::Vec3 way = volume::subtract(point(1), near);
  return {near, volume::scale(way, 1 / volume::length(way))};
}

/// How long the ray is in the box, in edges of the volume.
double length_within(const Ray& ray, const volume::Box& box) {
  double enter = 0, leave = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = (std::max(box.low[k], 0.0) - ray.origin[k]) / ray.direction[k];
    const double high = (std::min(box.high[k], 1.0) - ray.origin[k]) / ray.direction[k];
    enter = std::max(enter, std::min(low, high));
    leave = std::min(leave, std::max(low, high));
  }
  return std::max(0.0, leave - enter);
}

nlohmann::ordered_json simulate(const Settings& settings, int ranks) {
  const int side = settings.weak ? int(std::lround(settings.side * std::cbrt(double(ranks)))) : settings.side;
  const volume::VolumeDescription description = cube(side);
  const volume::KdTree tree(description, ranks);
  const volume::RenderRequest request = view(settings.pixels);
  std::vector<volume::Rect> footprints;
  std::vector<double> samples(std::size_t(ranks), 0.0);
  const std::vector<compositor::Rank> order = tree.visibility_order(request.texture_to_clip);
  const auto clip_to_texture = volume::inverse(request.texture_to_clip);
  // Every fourth ray each way stands for sixteen.
  constexpr int stride = 4;
  for (int rank = 0; rank < ranks; ++rank) {
    const volume::Rect& rect = footprints.emplace_back(volume::footprint(request, description, tree.box(rank)));
    const volume::Box box = volume::texture_box(description, tree.box(rank));
    for (int y = rect.y + (stride - rect.y % stride) % stride; y < rect.y + rect.height; y += stride)
      for (int x = rect.x + (stride - rect.x % stride) % stride; x < rect.x + rect.width; x += stride) {
        const auto clip = [&](int pixel) { return (2.0 * pixel + 1) / settings.pixels - 1; };
        samples[std::size_t(rank)] +=
            stride * stride * side * length_within(ray_through(*clip_to_texture, clip(x), clip(y)), box);
      }
  }
  const double most = *std::ranges::max_element(samples);
  double all = 0;
  for (const double of_rank : samples) all += of_rank;
  const compositor::LinkCost link{settings.latency, 8e-9 / settings.gigabits, 1e-9 * settings.ns_per_pixel};
  nlohmann::ordered_json row{{"ranks", ranks},
                             {"side", side},
                             {"samples", all},
                             {"imbalance", most * ranks / all},
                             {"render_ms", 1e-6 * settings.ns_per_sample * most},
                             {"one_rank_ms", 1e-6 * settings.ns_per_sample * all}};
  for (std::size_t a = 0; a < compositor::algorithm_count; ++a) {
    const auto algorithm = compositor::Algorithm(a);
    const compositor::ExchangeCost cost =
        compositor::cost(compositor::schedule(algorithm, order, footprints), compositor::Layout::rgba32f, link);
    constexpr double bytes = 16;
    row[std::string(compositor::name_of(algorithm))] = {{"messages", cost.messages},
                                                        {"bytes", bytes * double(cost.pixels_sent)},
                                                        {"most_bytes", bytes * double(cost.most_pixels_sent)},
                                                        {"ms", 1e3 * cost.seconds}};
  }
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"models frames of a dense cube on 1 to 1,024 ranks"};
  app.add_option("--side", settings.side, "voxels along each axis")->check(CLI::Range(8, 8192));
  app.add_flag("--weak", settings.weak, "that many for each rank");
  app.add_option("--pixels", settings.pixels, "edge of the picture")->check(CLI::Range(16, 8192));
  app.add_option("--most-ranks", settings.most_ranks, "powers of two up to here")->check(CLI::Range(1, 1024));
  app.add_option("--ns-per-sample", settings.ns_per_sample, "of a node's whole processor");
  app.add_option("--latency", settings.latency, "seconds a message");
  app.add_option("--gigabits", settings.gigabits, "a second, of each node's line")->check(CLI::PositiveNumber);
  app.add_option("--ns-per-pixel", settings.ns_per_pixel, "to blend one");
  CLI11_PARSE(app, argc, argv);
  try {
    for (int ranks = 1; ranks <= settings.most_ranks; ranks *= 2)
      fmt::print("{}\n", simulate(settings, ranks).dump());
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-scaling: {}\n", error.what());
    return 1;
  }
}
