// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/render_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/understudy/file_scene/scene_file.h"
#include "apps/understudy/images/image.h"
#include "apps/understudy/study/median.h"
#include "compositor/logging/log.h"
#include "compositor/rendered.h"
#include "compositor/service/loading_service.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

struct SceneFigures {
  int nodes = 0;
  std::vector<double> frame_ms;
};

/// Returns the image over the scene's viewport. Where no ray was cast, it has the value that changes nothing
/// when it is composited.
RgbaImage over_viewport(const volume::ImageView& image, const volume::RenderRequest& request) {
  const volume::Rect& viewport = request.viewport;
  const volume::Rect shared = intersection(viewport, image.rect);
  RgbaImage whole{viewport.width, viewport.height, true,
                  std::vector<float>(4 * viewport.pixels(), volume::neutral_value(request.op))};
  for (int y = shared.y; y < shared.y + shared.height; ++y) {
    const auto from = 4 * (std::size_t(y - image.rect.y) * std::size_t(image.rect.width) +
                           std::size_t(shared.x - image.rect.x));
    std::copy_n(image.rgba.data() + from, 4 * std::size_t(shared.width),
                whole.pixel(shared.x - viewport.x, viewport.height - 1 - (y - viewport.y)));
  }
  return whole;
}

RgbaImage over_black(RgbaImage image) {
  image.has_alpha = false;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1;
  return image;
}

void check_extent(const volume::Rect& viewport, const std::string& scene) {
  if (!viewport.empty() && viewport.width <= max_image_side && viewport.height <= max_image_side &&
      viewport.pixels() <= std::size_t(max_image_pixels))
    return;
  throw std::invalid_argument(
      fmt::format("{}: its image of {} x {} pixels is empty or too large; export a smaller "
                  "window",
                  scene, viewport.width, viewport.height));
}

SceneFigures render_with(compositor::LoadingService& service, const SceneFile& file,
                         const SceneToRender& what) {
  SceneFigures figures{service.nodes(), {}};
  send_scene(file, service);
  volume::RenderRequest request = file.scene.request;
  request.exact = true;
  for (int frame = 0; frame < what.frames; ++frame) {
    const auto start = Clock::now();
    const compositor::Rendered rendered = service.render(request);
    figures.frame_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    if (frame + 1 < what.frames) continue;
    const RgbaImage image = over_viewport(rendered.image, request);
    if (!what.save_float.empty()) write_pfm(what.save_float, image);
    write_png(what.out, over_black(image));
  }
  return figures;
}

}  // namespace

void refuse_options_with_scene(const CLI::App& render_command) {
  constexpr std::array<std::string_view, 23> possible{
      "VOLUME",    "out",         "save-float", "frames",     "progress", "quiet",   "nodes",      "hostfile",
      "connect",   "secret-file", "key",        "server-key", "plain",    "backend", "gpu-memory", "sort",
      "partition", "balance",     "exchange",   "pixels",     "gather",   "overlap", "help"};
  for (const CLI::Option* const option : render_command.get_options()) {
    const auto is = [&](std::string_view name) {
      return option->check_lname(std::string(name)) || option->get_name() == name;
    };
    if (option->count() == 0 || std::ranges::any_of(possible, is)) continue;
    throw std::invalid_argument(
        fmt::format("{} has no effect on an exported scene, which is complete by itself; leave it out, or "
                    "render its volume, "
                    "the .nhdr file beside it",
                    option->get_name()));
  }
}

int render_scene(const SceneToRender& what, const LoadingNodes& nodes) {
  const SceneFile file = read_scene_file(what.scene);
  check_extent(file.scene.request.viewport, what.scene);
  SceneFigures figures;
  std::vector<std::string> backends;
  try {
    backends = with_loading_nodes(nodes, [&](const ServiceMaker& make, const std::stop_token&) {
      figures = render_with(*make(), file, what);
    });
  } catch (const compositor::ServiceLost& lost) {
    throw std::runtime_error(fmt::format(
        "no image was rendered ({}); try again, or render in this process, without nodes", lost.what()));
  } catch (const compositor::RequestRefused& refused) {
    throw std::runtime_error(fmt::format("{}: {}", what.scene, refused.what()));
  }
  if (what.quiet) return 0;
  for (const std::string& choice : backends) logging::log(logging::Level::info, "{}", choice);
  const volume::VolumeDescription& volume = file.scene.volume;
  fmt::print("understudy: scene of frame {}: {} x {} x {} texels, {}: {} of {:.1f} ms\n",
             file.scene.origin.frame, volume.size[0], volume.size[1], volume.size[2],
             figures.nodes == 0 ? "in this process" : fmt::format("{} nodes", figures.nodes),
             figures.frame_ms.size() == 1 ? "1 frame" : fmt::format("{} frames", figures.frame_ms.size()),
             median(figures.frame_ms));
  return 0;
}

}  // namespace understudy::launcher
