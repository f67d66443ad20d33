// SPDX-License-Identifier: Apache-2.0
// understudy-bench-scaling: models the cost of an image on 1 to 1,024 ranks. Partition, rays, footprints and
// the bytes of every message are those of the nodes (frame_parts.h); only time is modelled (frame_time.h).
// Prints one JSON object a line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/frame_parts.h"
#include "apps/bench/frame_time.h"
#include "compositor/exchange/cost.h"
#include "volume/block_costs.h"
#include "volume/brick/brick_store.h"
#include "volume/file/texel_stream.h"
#include "volume/file/volume_file.h"
#include "volume/kd_tree.h"
#include "volume/opening/open_volume.h"
#include "volume/orbit_camera.h"
#include "volume/partition.h"
#include "volume/raycast/expected_samples.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace {

using namespace understudy;

struct Settings {
  int side = 512;              ///< number of voxels along each axis
  bool weak = false;           ///< weak scaling: `side` is for one rank; the volume grows with the ranks
  bool growing_image = false;  ///< `pixels` grows in proportion to the volume's side
  int pixels = 1024;
  int most_ranks = 1024;
  int cast_ranks = 0;  ///< boxes are really cast on up to this many ranks
  std::string volume;  ///< volume file, used instead of the cube
  std::string table = "vessels";
  bool by_cost = false;
  bench::Costs costs;
  double gigabits = 100;
};

/// What is drawn: texels, if there are any, and one image.
struct Scene {
  volume::VolumeDescription description;
  std::vector<std::byte> texels;
  volume::RenderRequest request;
};

/// A cube in which every sample is visible, and no ray terminates before it leaves the cube.
Scene dense_cube(const Settings& settings, int ranks) {
  const double growth = settings.weak ? std::cbrt(double(ranks)) : 1;
  const int side = int(std::lround(settings.side * growth));
  const int pixels = settings.growing_image ? int(std::lround(settings.pixels * growth)) : settings.pixels;
  Scene scene;
  scene.description.id = 1;
  scene.description.size = {side, side, side};
  scene.description.stored = {{0, 0, 0}, scene.description.size};
  scene.request = volume::orbit_request(scene.description, {1, 1, 1}, {}, pixels, pixels, 1);
  constexpr float faint = 1e-3F;
  scene.request.classification =
      volume::TransferFunction{0, 1, {{faint, faint, faint, faint}, {faint, faint, faint, faint}}};
  scene.request.termination = 0;
  if (ranks <= settings.cast_ranks) {
    scene.texels.resize(std::size_t(side) * std::size_t(side) * std::size_t(side));
    for (std::size_t i = 0; i < scene.texels.size(); ++i) scene.texels[i] = std::byte(i * 2654435761U >> 24);
  }
  return scene;
}

Scene volume_in_file(const Settings& settings) {
  Scene scene;
  auto file = volume::open_volume(settings.volume);
  const volume::FileDescription of_file = file->description();
  volume::VolumeDescription& description = scene.description;
  description.id = 1;
  description.size = of_file.size;
  description.stored = {{0, 0, 0}, description.size};
  volume::TexelStream stream(std::move(file), {}, description.stored);
  description.type = stream.mapping().type;
  while (!stream.done()) {
    const auto slice_range = stream.next(std::size_t(16) << 20);
    scene.texels.insert(scene.texels.end(), slice_range.texels.begin(), slice_range.texels.end());
  }
  scene.request = volume::orbit_request(description, of_file.spacing, {}, settings.pixels, settings.pixels, 1);
  scene.request.classification = volume::sampled(volume::control_points_named(settings.table), 0, 1, 1);
  return scene;
}

/// Returns the expected number of samples in each block.
volume::BlockCosts expected_costs(const Scene& scene, bool dense) {
  const volume::TexelBox lattice = volume::cell_lattice(scene.description).box();
  constexpr int block = volume::BrickStore::block_cells;
  if (!dense) {
    volume::BlockCosts costs(lattice, block);
    volume::BrickStore store(scene.description, lattice);
    store.add_slices(scene.description.stored, scene.texels);
    store.finish();
    volume::add_expected_samples(store, scene.request, costs);
    return costs;
  }
  // A hundred blocks along each axis are enough to resolve the density of the rays.
  const int longest = *std::ranges::max_element(scene.description.size);
  volume::BlockCosts costs(lattice, block * std::max(1, longest / (100 * block)));
  const std::array<int, 3>& counts = costs.counts();
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x) {
        volume::TexelBox cells;
        double size = 1;
        for (std::size_t k = 0; k < 3; ++k) {
          const int at = std::array{x, y, z}[k];
          cells.low[k] = lattice.low[k] + costs.edge() * at;
          cells.high[k] = std::min(cells.low[k] + costs.edge(), lattice.high[k]);
          size *= double(cells.high[k] - cells.low[k]) / scene.description.size[k];
        }
        volume::Vec3 middle;
        for (std::size_t k = 0; k < 3; ++k)
          middle[k] = (0.5 * (cells.low[k] + cells.high[k]) + 0.5) / scene.description.size[k];
        costs.values()[costs.index({x, y, z})] = size * volume::sample_density(scene.request, middle);
      }
  return costs;
}

volume::Partition partition_of(const Settings& settings, const Scene& scene, int ranks) {
  if (!settings.by_cost) return volume::by_blocks(scene.description, ranks);
  const volume::BlockCosts costs = expected_costs(scene, settings.volume.empty());
  return volume::by_cost(scene.description, ranks, volume::CostSums(costs));
}

nlohmann::ordered_json exchange_row(const Settings& settings, const bench::FrameParts& parts,
                                    compositor::Algorithm algorithm, double& render_ms) {
  // Rank 0 is on the application's machine, the others on machines of their own: images are gathered on rank 0.
  const compositor::CountedExchange counted = bench::counted(
      parts, algorithm, compositor::Gather::root, volume::Operator::over, compositor::Layout::rgba32f);
  const bench::FrameTime time = bench::time_of(parts, counted, settings.costs);
  render_ms = 1e3 * time.render;
  std::uint64_t busiest = 0;
  nlohmann::ordered_json rounds = nlohmann::ordered_json::array();
  for (const compositor::RankTraffic& rank : counted.ranks)
    busiest = std::max({busiest, rank.bytes_sent, rank.bytes_received});
  for (const compositor::CountedRound& round : counted.rounds) {
    std::uint64_t bytes = 0, most = 0;
    for (const compositor::RankTraffic& rank : round.ranks) {
      bytes += rank.bytes_sent;
      most = std::max({most, rank.bytes_sent, rank.bytes_received});
    }
    rounds.push_back({{"messages", round.messages.size()}, {"bytes", bytes}, {"busiest", most}});
  }
  return {{"messages", counted.messages},
          {"bytes", counted.bytes},
          {"bytes_a_rank", double(counted.bytes) / double(parts.ranks.size())},
          {"bytes_of_the_busiest", busiest},
          {"ms", 1e3 * time.exchange},
          {"rounds", rounds}};
}

nlohmann::ordered_json simulate(const Settings& settings, const Scene& scene, int ranks) {
  const volume::KdTree tree(scene.description, partition_of(settings, scene, ranks));
  const bool cast = !scene.texels.empty();
  const bench::FrameParts parts = cast ? bench::cast_parts(scene.description, scene.texels, scene.request, tree)
                                       : bench::parts_of_rays(scene.description, scene.request, tree);
  std::uint64_t most = 0;
  for (const bench::RankPart& part : parts.ranks) most = std::max(most, part.samples);
  nlohmann::ordered_json row{{"ranks", ranks},
                             {"size", scene.description.size},
                             {"pixels", scene.request.window.width},
                             {"parts", cast ? "cast" : "rays"},
                             {"samples", parts.samples()},
                             {"imbalance", double(most) * ranks / double(parts.samples())},
                             {"one_rank_ms", 1e3 * bench::time_on_one_rank(parts, settings.costs)}};
  double render_ms = 0;
  for (std::size_t a = 0; a < compositor::algorithm_count; ++a) {
    const auto algorithm = compositor::Algorithm(a);
    row[std::string(compositor::name_of(algorithm))] = exchange_row(settings, parts, algorithm, render_ms);
  }
  row["render_ms"] = render_ms;
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Models images of a dense cube, or of a volume file, on 1 to 1,024 ranks."};
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("--side", settings.side, "number of voxels along each axis")->check(CLI::Range(8, 8192));
  CLI::Option* weak =
      app.add_flag("--weak", settings.weak,
                   "weak scaling: --side is for one rank, and the volume grows with the number of ranks");
  app.add_flag("--growing-image", settings.growing_image, "let the image grow with the volume")->needs(weak);
  app.add_option("--pixels", settings.pixels, "edge of the image, in pixels")->check(CLI::Range(16, 8192));
  app.add_option("--most-ranks", settings.most_ranks, "model powers of two up to this number of ranks")
      ->check(CLI::Range(1, 1024));
  app.add_option("--cast-ranks", settings.cast_ranks,
                 "measure the casting of boxes up to this number of ranks, instead of modelling it");
  app.add_option("--volume", settings.volume, "volume file, which is always cast, instead of the cube")
      ->excludes(weak);
  app.add_option("--table", settings.table,
                 "transfer function of the volume: " + volume::built_in_control_points());
  app.add_flag("--by-cost", settings.by_cost, "cut boxes of equal cost, instead of equal numbers of blocks");
  app.add_option("--sample", settings.costs.per_sample, "time per sample on all cores of a node, in seconds");
  app.add_option("--latency", settings.costs.latency, "latency L of a message, in seconds");
  app.add_option("--overhead", settings.costs.overhead, "overhead o of a message at either end, in seconds");
  app.add_option("--gap", settings.costs.gap, "gap g between messages, in seconds");
  app.add_option("--gigabits", settings.gigabits,
                 "bandwidth 1/G of each node's network connection, in gigabits per second")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  settings.costs.per_byte = 8e-9 / settings.gigabits;
  try {
    std::optional<Scene> given;
    if (!settings.volume.empty()) given = volume_in_file(settings);
    for (int ranks = 1; ranks <= settings.most_ranks; ranks *= 2)
      fmt::print("{}\n", simulate(settings, given ? *given : dense_cube(settings, ranks), ranks).dump());
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-scaling: {}\n", error.what());
    return 1;
  }
}
