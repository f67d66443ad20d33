// SPDX-License-Identifier: Apache-2.0
// understudy-bench-real-ranks: compares images of real node groups on this machine with the model
// (frame_parts.h, frame_time.h): bytes and messages, which must be equal, and times. Prints one JSON object a
// line. The costs of messages, bytes and blending are those printed by understudy-bench-messages; the costs of
// samples and rays are measured on one rank.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/bench/frame_parts.h"
#include "apps/bench/frame_time.h"
#include "apps/understudy/launch/own_node_group.h"
#include "compositor/rendered.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/remote_service.h"
#include "volume/file/synthetic.h"
#include "volume/file/texel_stream.h"
#include "volume/frame_counts.h"
#include "volume/orbit_camera.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace {

using namespace understudy;
using compositor::Algorithm;
using compositor::Gather;

struct Settings {
  int most_ranks = 8;
  int side = 128;
  int pixels = 512;
  int images = 8;
  int rounds = 1;
  int cores = int(std::max(1U, std::thread::hardware_concurrency()));
  std::string costs;
};

/// A volume and a request for one image of it.
struct Scene {
  std::string name;
  compositor::LoadRequest load;
  std::vector<std::byte> texels;
  volume::RenderRequest request;
  volume::RenderRequest sparser;  ///< the same rays, with a quarter of the samples
};

Scene scene_of(const Settings& settings, volume::VolumeId id, const std::string& kind) {
  Scene scene;
  scene.name = kind;
  scene.load.file = fmt::format("synthetic:{0}x{0}x{0}:u8:{1}", settings.side, kind);
  volume::VolumeDescription& description = scene.load.volume;
  description.id = id;
  description.size = {settings.side, settings.side, settings.side};
  description.stored = {{0, 0, 0}, description.size};
  volume::TexelStream stream(volume::open_synthetic(scene.load.file), {}, description.stored);
  description.type = stream.mapping().type;
  while (!stream.done()) {
    const auto slice_range = stream.next(std::size_t(16) << 20);
    scene.texels.insert(scene.texels.end(), slice_range.texels.begin(), slice_range.texels.end());
  }
  const auto request = [&](double step) {
    volume::RenderRequest made =
        volume::orbit_request(description, {1, 1, 1}, {}, settings.pixels, settings.pixels, step);
    made.classification = volume::sampled(volume::control_points_named("grey"), 0, 1, step);
    return made;
  };
  scene.request = request(1);
  scene.sparser = request(4);
  // Disable early ray termination: in the volume that is nowhere empty, the time is then that of all samples.
  // Also, the savings from opaque tiles depend on when their control messages arrive.
  scene.request.termination = scene.sparser.termination = 0;
  return scene;
}

/// The shortest times of several images, in milliseconds.
struct Measured {
  double render = std::numeric_limits<double>::max();
  double exchange = render;
  double frame = render;
  volume::FrameCounts counts;
};

void draw(compositor::LoadingService& service, const volume::RenderRequest& request, int images,
          Measured& measured) {
  for (int image = 0; image < images; ++image) {
    const auto start = std::chrono::steady_clock::now();
    measured.counts = service.render(request).counts;
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
    measured.frame = std::min(measured.frame, taken.count());
    measured.render = std::min(measured.render, measured.counts.render_ms);
    measured.exchange = std::min(measured.exchange, measured.counts.composite_ms);
  }
}

struct Way {
  int ranks = 1;
  Algorithm algorithm{};
  Gather gather{};
  auto operator<=>(const Way&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

const char* name_of(Gather gather) {
  return gather == Gather::direct ? "direct" : "gathered";
}

struct WayMeasured {
  std::vector<Measured> scenes;
  Measured sparser;  ///< of the last scene in `scenes`
};

void measure(const Settings& settings, const std::vector<Scene>& scenes, const Way& way,
             WayMeasured& measured) {
  measured.scenes.resize(scenes.size());
  launcher::OwnNodes nodes;
  nodes.placement.ranks = way.ranks;
  nodes.choices.exchange = compositor::name_of(way.algorithm);
  nodes.choices.gather = name_of(way.gather);
  nodes.choices.overlap = nodes.choices.packed = "off";
  launcher::with_own_nodes(nodes, [&](const std::string& socket, const std::stop_token&) {
    constexpr std::chrono::minutes patience{5};
    const auto service =
        compositor::remote_loading_service(socket, {patience, patience, patience, patience, patience});
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const Scene& scene = scenes[i];
      service->begin_load(scene.load);
      while (!std::ranges::all_of(service->continue_load(scene.load.volume.id), &compositor::RankLoad::done)) {
      }
      draw(*service, scene.request, settings.images, measured.scenes[i]);
      if (i + 1 == scenes.size() && way.ranks == 1)
        draw(*service, scene.sparser, settings.images, measured.sparser);
    }
  });
}

bench::Costs message_cost(const Settings& settings) {
  bench::Costs costs;
  costs.cores = settings.cores;
  if (settings.costs.empty()) return costs;
  const auto given = nlohmann::json::parse(settings.costs);
  // Between ranks of one machine, the latency of a small message is processor time at both ends.
  costs.latency = 0;
  costs.overhead = costs.gap = double(given.at("latency")) / 2;
  costs.per_byte = given.at("per_byte");
  costs.per_byte_packed = given.at("per_byte_packed");
  costs.per_byte_unpacked = given.at("per_byte_unpacked");
  costs.per_pixel_blended = given.at("per_pixel_blended");
  costs.per_pixel_written = given.at("per_pixel_written");
  return costs;
}

/// Derives the costs of samples and rays from the times of one rank, which uses all cores.
void calibrate(bench::Costs& costs, const Settings& settings, const Scene& scene, const WayMeasured& one_rank) {
  const volume::KdTree tree(scene.load.volume, 1);
  const bench::FrameParts all = bench::cast_parts(scene.load.volume, scene.texels, scene.request, tree),
                          few = bench::cast_parts(scene.load.volume, scene.texels, scene.sparser, tree);
  const double longer = one_rank.scenes.back().render, shorter = one_rank.sparser.render;
  costs.per_sample =
      1e-3 * settings.cores * (longer - shorter) / (double(all.samples()) - double(few.samples()));
  const double left = 1e-3 * settings.cores * longer - costs.per_sample * double(all.samples());
  costs.per_pixel_cast = std::max(0.0, left) / double(all.ranks.front().cast.pixels());
}

using MeasuredWays = std::map<Way, WayMeasured>;
using RenderTimes = std::map<std::pair<int, std::size_t>, double>;  ///< by ranks and scene

MeasuredWays measure_all(const Settings& settings, const std::vector<Scene>& scenes) {
  MeasuredWays measured;
  // The number of ranks varies fastest, so that a temporary load of the machine affects all of them.
  for (int round = 0; round < settings.rounds; ++round)
    for (std::size_t a = 0; a < compositor::algorithm_count; ++a)
      for (const Gather gather : {Gather::direct, Gather::root})
        for (int ranks = 1; ranks <= settings.most_ranks; ++ranks) {
          const Way way{ranks, Algorithm(a), gather};
          measure(settings, scenes, way, measured[way]);
        }
  return measured;
}

/// Rendering does not depend on the exchange, so its shortest time is taken over all ways.
RenderTimes render_times(const MeasuredWays& measured, std::size_t scenes) {
  RenderTimes render;
  for (const auto& [way, of_way] : measured)
    for (std::size_t i = 0; i < scenes; ++i) {
      const auto [known, first] = render.try_emplace({way.ranks, i}, of_way.scenes[i].render);
      if (!first) known->second = std::min(known->second, of_way.scenes[i].render);
    }
  return render;
}

void print(const Settings& settings, const bench::Costs& costs) {
  fmt::print("{}\n", nlohmann::ordered_json{{"cores", settings.cores},
                                            {"ns_per_sample", 1e9 * costs.per_sample},
                                            {"ns_per_pixel_cast", 1e9 * costs.per_pixel_cast},
                                            {"us_per_message", 2e6 * costs.overhead},
                                            {"ns_per_byte", 1e9 * costs.per_byte},
                                            {"ns_per_byte_packed", 1e9 * costs.per_byte_packed},
                                            {"ns_per_byte_unpacked", 1e9 * costs.per_byte_unpacked},
                                            {"ns_per_pixel_blended", 1e9 * costs.per_pixel_blended},
                                            {"ns_per_pixel_written", 1e9 * costs.per_pixel_written}}
                         .dump());
}

void print(const Scene& scene, const Way& way, const Measured& real, double measured_render,
           const bench::FrameParts& parts, const bench::Costs& costs) {
  const compositor::CountedExchange counted =
      bench::counted(parts, way.algorithm, way.gather, scene.request.op, compositor::Layout::rgba32f);
  const bench::FrameTime time = bench::time_of(parts, counted, costs);
  fmt::print("{}\n", nlohmann::ordered_json{{"scene", scene.name},
                                            {"ranks", way.ranks},
                                            {"exchange", compositor::name_of(way.algorithm)},
                                            {"gather", name_of(way.gather)},
                                            {"samples", parts.samples()},
                                            {"samples_counted", real.counts.samples_taken},
                                            {"messages", counted.messages},
                                            {"messages_counted", real.counts.messages},
                                            {"bytes", counted.bytes},
                                            {"bytes_counted", real.counts.bytes_exchanged},
                                            {"render_ms", 1e3 * time.render},
                                            {"render_ms_measured", measured_render},
                                            {"exchange_ms", 1e3 * time.exchange},
                                            {"exchange_ms_measured", real.exchange},
                                            {"frame_ms", 1e3 * (time.render + time.exchange)},
                                            {"frame_ms_measured", real.frame}}
                         .dump());
}

void run(const Settings& settings) {
  const std::vector<Scene> scenes{scene_of(settings, 1, "shells"), scene_of(settings, 2, "lobes")};
  const MeasuredWays measured = measure_all(settings, scenes);
  bench::Costs costs = message_cost(settings);
  const RenderTimes render = render_times(measured, scenes.size());
  WayMeasured one_rank = measured.begin()->second;
  for (const auto& [way, of_way] : measured)
    one_rank.sparser.render = std::min(one_rank.sparser.render, of_way.sparser.render);
  one_rank.scenes.back().render = render.at({1, scenes.size() - 1});
  calibrate(costs, settings, scenes.back(), one_rank);
  print(settings, costs);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    for (int ranks = 1; ranks <= settings.most_ranks; ++ranks) {
      const volume::KdTree tree(scene.load.volume, ranks);
      const bench::FrameParts parts = bench::cast_parts(scene.load.volume, scene.texels, scene.request, tree);
      for (const auto& [way, of_way] : measured)
        if (way.ranks == ranks) print(scene, way, of_way.scenes[i], render.at({ranks, i}), parts, costs);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Compares the model of images on many ranks with real ranks on this machine."};
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("--most-ranks", settings.most_ranks, "largest number of ranks")->check(CLI::Range(1, 64));
  app.add_option("--side", settings.side, "number of voxels along each axis")->check(CLI::Range(16, 512));
  app.add_option("--pixels", settings.pixels, "edge of the image, in pixels")->check(CLI::Range(16, 4096));
  app.add_option("--images", settings.images, "number of images of each kind, of which the fastest counts")
      ->check(CLI::Range(1, 1000));
  app.add_option("--rounds", settings.rounds, "number of rounds; each times all methods one after another")
      ->check(CLI::Range(1, 100));
  app.add_option("--cores", settings.cores, "number of cores that the ranks share")->check(CLI::Range(1, 1024));
  app.add_option("--costs", settings.costs, "message costs, as printed by understudy-bench-messages");
  CLI11_PARSE(app, argc, argv);
  try {
    run(settings);
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-real-ranks: {}\n", error.what());
    return 1;
  }
}
