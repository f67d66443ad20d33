// SPDX-License-Identifier: Apache-2.0
// understudy-bench-balance: renders one scene without balancing, with two settings of Mueller's
// balancer, and with the predicting balancer. Prints one JSON object a line for each balancer: its sums,
// and the figures of its images.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/balance_trace.h"
#include "volume/file/texel_stream.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/segment_scene.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace {

using namespace understudy;

struct Settings {
  std::string scene;
  std::vector<std::string> volumes;
  std::string table = "engine";
  int ranks = 4;
  int pixels = 256;
  int images = 160;
  unsigned seed = 1;
};

const std::vector<std::string> scenes{"turning",  "slowed-surface", "slowed-volume", "slowed-lit",
                                      "switched", "zooming",        "changing"};

/// Texels of the volumes in files, all of one size; the bytes are normalised to the range common to all files.
struct Loaded {
  volume::VolumeDescription description;
  volume::Vec3 spacing{1, 1, 1};
  std::vector<std::vector<std::byte>> texels;
};

Loaded load(const std::vector<std::string>& names) {
  Loaded loaded;
  for (const std::string& name : names) {
    auto file = volume::open_volume(name);
    const volume::FileDescription description = file->description();
    const volume::TexelBox all{{0, 0, 0}, description.size};
    volume::TexelStream stream(std::move(file), {}, all);
    if (!loaded.texels.empty() &&
        (loaded.description.size != description.size || loaded.description.type != stream.mapping().type))
      throw std::invalid_argument(fmt::format("{} differs from the first volume in size or type", name));
    loaded.description.size = description.size;
    loaded.description.type = stream.mapping().type;
    loaded.description.stored = all;
    loaded.spacing = description.spacing;
    std::vector<std::byte>& texels = loaded.texels.emplace_back();
    while (!stream.done()) {
      const auto slice_range = stream.next(std::size_t(16) << 20);
      texels.insert(texels.end(), slice_range.texels.begin(), slice_range.texels.end());
    }
  }
  return loaded;
}

double largest_value(const Loaded& loaded) {
  if (loaded.description.type != volume::TexelType::f32) return 1;
  float largest = 0;
  for (const std::vector<std::byte>& texels : loaded.texels)
    for (std::size_t at = 0; at + sizeof(float) <= texels.size(); at += sizeof(float)) {
      float value = 0;
      std::memcpy(&value, texels.data() + at, sizeof value);
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  return double(largest);
}

bench::TraceScene scene_of(const Settings& settings) {
  auto loaded = std::make_shared<Loaded>(load(settings.volumes));
  const double step = 1, top = largest_value(*loaded);
  const volume::TransferFunction table =
      volume::sampled(volume::control_points_named(settings.table), 0, top, step);
  // The second transfer function shows only the densest parts.
  volume::TransferControlPoints dense = volume::control_points_named("grey");
  dense.control_points = {{0, {1, 1, 1}, 0}, {0.7, {1, 1, 1}, 0}, {0.75, {1, 1, 1}, 0.3}, {1, {1, 1, 1}, 0.6}};
  const volume::TransferFunction second = volume::sampled(dense, 0, top, step);

  bench::TraceScene scene;
  scene.ranks = settings.ranks;
  scene.seed = settings.seed;
  scene.images = settings.images;
  const std::string& name = settings.scene;
  const bool slowed = name.starts_with("slowed"), changing = name == "changing";
  const int images = scene.images, volumes = int(loaded->texels.size());
  const auto make_request = [=, spacing = loaded->spacing](const volume::VolumeDescription& description,
                                                           int image) {
    volume::OrbitCamera camera;
    camera.azimuth = 30 + (slowed ? 0.2 : 1.0) * image;
    if (name == "zooming") {
      camera.distance = 2.5 + 1.7 * std::cos(2 * std::numbers::pi * 3 * image / images);
      camera.azimuth = 30;
    }
    volume::RenderRequest request =
        volume::orbit_request(description, spacing, camera, settings.pixels, settings.pixels, step);
    request.classification = name == "switched" && image / 50 % 2 == 1 ? second : table;
    if (name == "slowed-surface") {
      volume::TransferFunction nothing = table;
      std::ranges::fill(nothing.entries, volume::Rgba{});
      request.classification = nothing;
      request.surfaces = {{0.4, {0.9F, 0.9F, 0.9F, 1}}};
    }
    if (name == "slowed-lit") request.light.emplace();
    if (changing) request.version = std::uint64_t(image * volumes / images);
    return request;
  };
  scene.description = loaded->description;
  scene.description.id = 1;
  scene.description.ghost_layer =
      volume::ghost_layer_needed(scene.description, make_request(scene.description, 0));
  scene.request = [make_request, description = scene.description](int image) {
    return make_request(description, image);
  };
  scene.texels = [loaded](std::uint64_t version) { return loaded->texels[version]; };
  if (slowed) {
    const int from = images / 4;
    scene.relative_cost = [from](int image, int rank) { return rank == 1 && image >= from ? 4.0 : 1.0; };
    scene.events = {0, from};
  }
  if (name == "switched") {
    scene.events.clear();
    for (int image = 0; image < images; image += 50) scene.events.push_back(image);
  }
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Renders one scene with each method of load balancing between ranks."};
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("scene", settings.scene, "scene to render")->required()->check(CLI::IsMember(scenes));
  app.add_option("volumes", settings.volumes, "volume files; several are shown one after another")->required();
  app.add_option("--table", settings.table, "transfer function: " + volume::built_in_control_points());
  app.add_option("--ranks", settings.ranks, "number of ranks")->check(CLI::Range(1, 64));
  app.add_option("--pixels", settings.pixels, "edge of the image, in pixels")->check(CLI::Range(16, 4096));
  app.add_option("--images", settings.images, "number of images")->check(CLI::Range(10, 10000));
  app.add_option("--seed", settings.seed, "seed of the noise in the times");
  CLI11_PARSE(app, argc, argv);
  try {
    bench::TracePlayer player(scene_of(settings));
    // No single setting of Mueller's balancer suits every scene: the default one reverses a move readily,
    // the firm one hardly ever.
    compositor::MullerSettings firm;
    firm.raised_by = 10;
    std::vector<std::pair<const char*, std::unique_ptr<compositor::Balancer>>> balancers;
    balancers.emplace_back("static", nullptr);
    balancers.emplace_back("muller", compositor::muller_balancer());
    balancers.emplace_back("muller-firm", compositor::muller_balancer(firm));
    balancers.emplace_back("predicted", compositor::predicting_balancer());
    for (const auto& [name, balancer] : balancers) {
      const std::vector<bench::TraceImage> trace = player.play(balancer.get());
      const bench::TraceSums sums = player.sums(trace);
      nlohmann::ordered_json row{{"balance", name},
                                 {"mean_ms", sums.mean_ms},
                                 {"ideal_ms", sums.ideal_ms},
                                 {"mean_deviation", sums.mean_deviation},
                                 {"end_deviation", sums.end_deviation},
                                 {"settling", sums.settling},
                                 {"bytes", sums.bytes},
                                 {"planes_moved", sums.planes_moved},
                                 {"reversals", sums.reversals}};
      for (const bench::TraceImage& image : trace) {
        row["render_ms"].push_back(image.render_ms);
        row["transfer_ms"].push_back(image.transfer_ms);
        row["deviation"].push_back(image.deviation);
        row["image_bytes"].push_back(image.bytes);
        row["cuts"].push_back(image.cuts);
      }
      fmt::print("{}\n", row.dump());
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-balance: {}\n", error.what());
    return 1;
  }
}
