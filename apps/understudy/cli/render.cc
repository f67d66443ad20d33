// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/render.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/cli/render_report.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/load_progress.h"
#include "apps/understudy/images/image.h"
#include "apps/understudy/study/median.h"
#include "compositor/logging/log.h"
#include "compositor/rendered.h"
#include "volume/image.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using compositor::LoadingService;
using compositor::RankLoad;

constexpr int max_frames = 10000;

struct RenderArguments {
  SceneArguments scene;
  LoadingNodes nodes;
  int frames = 1;
  std::string out;
  std::string report;
  std::string save_float;
  bool progress = false;
};

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Over black, or as it is with its alpha.
RgbaImage image_of(const volume::ImageView& image, const volume::Rect& window, bool with_alpha) {
  RgbaImage file_image = whole_window(image, window);
  file_image.has_alpha = with_alpha;
  if (!with_alpha)
    for (std::size_t i = 3; i < file_image.rgba.size(); i += 4) file_image.rgba[i] = 1;
  return file_image;
}

/// Of an image of bounds.
BoundFigures bound_figures(const volume::ImageView& image) {
  std::vector<double> bounds;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    if (image.rgba[i] > 0) bounds.push_back(std::min(double(image.rgba[i]), 1.0));  // no channel shows more
  if (bounds.empty()) return {};
  return {*std::ranges::max_element(bounds), median(bounds), 0};
}

RenderFigures render_with(LoadingService& service, const FileScene& scene, const RenderArguments& arguments) {
  RenderFigures figures;
  figures.file = scene.load.file;
  figures.description = scene.file;
  figures.mapping = scene.mapping;
  figures.width = scene.image.width;
  figures.height = scene.image.height;
  figures.step = scene.image.step;
  figures.nodes = service.nodes();

  auto start = Clock::now();
  figures.ranks = service.begin_load(scene.load);
  figures.open_ms = milliseconds_since(start);
  start = Clock::now();
  {
    using Style = LoadProgress::Style;
    LoadProgress progress(arguments.progress             ? Style::lines
                          : ::isatty(STDERR_FILENO) != 0 ? Style::bar
                                                         : Style::silent);
    progress.show(figures.ranks);
    while (!std::ranges::all_of(figures.ranks, &RankLoad::done)) {
      figures.ranks = service.continue_load(scene.load.volume.id);
      progress.show(figures.ranks);
    }
  }
  figures.load_ms = milliseconds_since(start);

  figures.request = request_of(scene, scene.image, texel_figures(figures.ranks));
  volume::RenderRequest bounding = figures.request;
  figures.request.bound_of.reset();
  for (int frame = 0; frame < arguments.frames; ++frame) {
    start = Clock::now();
    const compositor::Rendered rendered = service.render(figures.request);
    figures.frame_ms.push_back(milliseconds_since(start));
    figures.counts = rendered.counts;
    if (frame + 1 < arguments.frames) continue;
    write_png(arguments.out, image_of(rendered.image, figures.request.window, false));
    if (!arguments.save_float.empty())
      write_pfm(arguments.save_float, image_of(rendered.image, figures.request.window, true));
  }
  if (bounding.bound_of) {
    start = Clock::now();
    figures.bound = bound_figures(service.render(bounding).image);
    figures.bound->time_ms = milliseconds_since(start);
  }
  figures.ranks = service.continue_load(scene.load.volume.id);
  return figures;
}

int render(const RenderArguments& arguments) {
  const FileScene scene = scene_of(arguments.scene);
  RenderFigures figures;
  std::vector<std::string> backends;
  try {
    backends = with_loading_nodes(arguments.nodes, [&](const ServiceMaker& make, const std::stop_token&) {
      figures = render_with(*make(), scene, arguments);
    });
  } catch (const compositor::ServiceLost& lost) {
    throw std::runtime_error(
        fmt::format("no image was made: render again, or in this process, without nodes ({})", lost.what()));
  }
  figures.backends = backends;
  for (const std::string& choice : backends) logging::log(logging::Level::info, "{}", choice);
  if (!arguments.report.empty()) write_render_report(arguments.report, figures);
  std::fputs(summary_text(figures).c_str(), stdout);
  return 0;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<RenderArguments>();
  CLI::App* render_command = app.add_subcommand("render", "an image of a volume in a file, without a viewer");
  add_scene_options(*render_command, arguments->scene);
  add_loading_nodes(*render_command, arguments->nodes);
  render_command->add_option("--out", arguments->out, "the image, over black")
      ->type_name("P.png")
      ->required()
      ->check(can_be_written(".png"));
  render_command
      ->add_option(
          "--level", arguments->scene.level,
          "of a hierarchical volume: a coarser level of detail, with every 2nd (1), 4th (2), … sample; "
          "--step is in its samples")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  render_command
      ->add_option("--save-float", arguments->save_float, "the image before it is rounded, and its alpha")
      ->type_name("F.pfm")
      ->check(can_be_written(".pfm"));
  render_command->add_option("--report", arguments->report, "figures as JSON")
      ->type_name("F.json")
      ->check(can_be_written());
  render_command->add_flag("--error-bound", arguments->scene.error_bound,
                           "say by how much any pixel may be wrong, certified");
  render_command->add_option("--frames", arguments->frames, "render as often, for the time")
      ->check(CLI::Range(1, max_frames))
      ->capture_default_str();
  render_command->add_flag("--progress", arguments->progress,
                           "loading as lines, with the bytes read by each rank");
  render_command->callback([arguments, &chosen] { chosen = [arguments] { return render(*arguments); }; });
}

}  // namespace understudy::launcher
