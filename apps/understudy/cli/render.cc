// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/understudy/cli/budget_options.h"
#include "apps/understudy/cli/certified_step.h"
#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/cli/memory_option.h"
#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/cli/render_report.h"
#include "apps/understudy/cli/render_scene.h"
#include "apps/understudy/cli/scene_frames.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/load_progress.h"
#include "apps/understudy/file_scene/scene_file.h"
#include "apps/understudy/images/image.h"
#include "apps/understudy/progress/progress_option.h"
#include "compositor/logging/log.h"
#include "compositor/passes/pass_plan.h"
#include "compositor/passes/pass_renderer.h"
#include "compositor/rendered.h"
#include "volume/cell_lattice.h"
#include "volume/image.h"
#include "volume/opening/open_volume.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using compositor::LoadingService;

constexpr int max_frames = 10000;

struct RenderArguments {
  SceneArguments scene;
  LoadingNodes nodes;
  int frames = 1;
  std::string out;
  std::string report;
  std::string save_float;
  std::string memory = "auto";
  BudgetArguments budget;
  ProgressOptions progress;
};

/// A bound holds for the image that is computed, and is itself an image: neither may be rounded on its way.
void refuse_rounded_bounds(const RenderArguments& arguments) {
  if (!arguments.scene.error_bound) return;
  if (arguments.nodes.choices.pixels != "float")
    throw std::invalid_argument(fmt::format(
        "--error-bound does not include the rounding of --pixels {}; give --pixels float, the default",
        arguments.nodes.choices.pixels));
  if (arguments.nodes.connection.connection_request.jpeg_quality > 0)
    throw std::invalid_argument("--error-bound does not include what JPEG images lose; leave out --quality");
}

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Returns the image over black, or unchanged with its alpha.
RgbaImage image_of(const volume::ImageView& image, const volume::Rect& window, bool with_alpha) {
  RgbaImage file_image = whole_window(image, window);
  file_image.has_alpha = with_alpha;
  if (!with_alpha)
    for (std::size_t i = 3; i < file_image.rgba.size(); i += 4) file_image.rgba[i] = 1;
  return file_image;
}

/// The parts in which a volume is rendered within the ranks' memory: one if it fits as a whole.
struct Passes {
  volume::Partition parts;
  compositor::LoadRequest load;
};

Passes passes_of(const volume::VolumeFile& file, const FileScene& scene, const RenderArguments& arguments,
                 int ranks) {
  VolumeMemory memory = memory_for_volume(arguments.memory, ranks, ranks_are_here(arguments.nodes),
                                          std::size_t(scene.image.width) * std::size_t(scene.image.height),
                                          arguments.scene.samples_are_free);
  // Error bounds take 28 bytes for each 8 cells, in addition to the 12 that their bricks take at least.
  if (scene.image.bounds_error) memory.bytes /= 4;
  Passes passes{{}, scene.load};
  const volume::VolumeDescription& volume = scene.load.volume;
  auto parts = compositor::passes_within(volume, file, ranks, memory.bytes);
  if (!parts)
    throw std::invalid_argument(fmt::format(
        "no part of this volume fits into {} MiB for each rank; increase --memory, or use more nodes",
        memory.bytes >> 20U));
  passes.parts = *std::move(parts);
  // A part is divided among all ranks, whereas one rank may keep a whole volume for the others.
  if (memory.of_each_process && passes.parts.ranks == 1 && ranks > 1 &&
      compositor::bytes_of_rank(volume, file, 1) > memory.bytes)
    passes.load.volume.part = volume::shown_cells(volume);
  return passes;
}

void take_certified(CertifiedStep certified, RenderFigures& figures) {
  figures.step = certified.step;
  figures.request = std::move(certified.request);
  figures.bound = certified.bound;
}

/// Returns a function that shows how far the search for a step has come.
std::function<void(double, double)> show_bound(Progress& progress) {
  return [&progress](double step, double bound) {
    progress.show(0, fmt::format("certifying: within {:.3g} at a step of {:.3g} voxels", bound, step));
  };
}

RenderFigures render_with(LoadingService& service, const FileScene& scene, const RenderArguments& arguments) {
  RenderFigures figures;
  figures.file = scene.load.file;
  figures.time_step = scene.time_step;
  if (scene.file.channels > 1) figures.channel = scene.load.hints.channel;
  figures.description = scene.file;
  figures.mapping = scene.mapping;
  figures.width = scene.image.width;
  figures.height = scene.image.height;
  figures.step = scene.image.step;
  figures.nodes = service.nodes();

  auto start = Clock::now();
  const auto file = volume::open_volume(scene.load.file, scene.load.hints);
  const Passes passes = passes_of(*file, scene, arguments, std::max(1, service.nodes()));
  figures.open_ms = milliseconds_since(start);
  start = Clock::now();
  Progress progress(arguments.progress.style());
  compositor::PassRenderer renderer(service, *file, passes.load, passes.parts,
                                    [&](int part, int of, std::span<const compositor::RankLoad> ranks) {
                                      show_load(progress, part, of, ranks);
                                    });
  renderer.load(unclassified_request(scene, scene.image));
  figures.ranks = renderer.ranks();
  figures.load_ms = milliseconds_since(start);

  spu::BudgetAsked asked = budget_asked(arguments.budget, arguments.nodes.choices.pixels == "float");
  const volume::RenderRequest bounding = request_of(scene, scene.image, texel_figures(figures.ranks));
  if (bounding.bound_of && asked.error > 0) {
    take_certified(
        certified_step(renderer, scene, texel_figures(figures.ranks), asked.error, show_bound(progress)),
        figures);
    asked = {};
  } else {
    figures.request = bounding;
    figures.request.bound_of.reset();
    figures.request.exact = bounding.bound_of || asked.error > 0;  // nodes that run already may round others
  }
  const volume::RenderRequest own = figures.request;
  const bool in_parts = passes.parts.ranks > 1;
  if (in_parts && asked.ms > 0 && asked.error == 0)
    throw std::invalid_argument(
        "--time requires that the whole volume fits into memory; increase --memory, or give --error instead");
  SceneFrames frames(renderer, scene.load.volume, own, asked);
  if (in_parts) frames.look_no_more();
  for (int frame = 0; frame < arguments.frames; ++frame) {
    const compositor::Rendered rendered = frames.next(figures);
    if (frame + 1 < arguments.frames) continue;
    write_png(arguments.out, image_of(rendered.image, figures.request.window, false));
    if (!arguments.save_float.empty())
      write_pfm(arguments.save_float, image_of(rendered.image, figures.request.window, true));
  }
  if (bounding.bound_of && !figures.bound) {
    start = Clock::now();
    figures.bound = bound_figures(renderer.render(bounding).image);
    figures.bound->time_ms = milliseconds_since(start);
  }
  figures.ranks = renderer.ranks();
  figures.passes = renderer.figures();
  return figures;
}

bool is_scene(const RenderArguments& arguments) {
  return arguments.scene.volumes.size() == 1 && is_scene_file(arguments.scene.volumes.front());
}

int render(RenderArguments arguments, const CLI::App& command) {
  if (is_scene(arguments)) {
    refuse_options_with_scene(command);
    return render_scene({arguments.scene.volumes.front(), arguments.out, arguments.save_float, arguments.frames,
                         arguments.progress.quiet},
                        arguments.nodes);
  }
  refuse_rounded_bounds(arguments);
  arguments.scene.samples_are_free =
      !arguments.scene.error_bound &&
      budget_asked(arguments.budget, arguments.nodes.choices.pixels == "float").any();
  const FileScene scene = scene_of(arguments.scene);
  RenderFigures figures;
  std::vector<std::string> backends;
  try {
    backends = with_loading_nodes(arguments.nodes, [&](const ServiceMaker& make, const std::stop_token&) {
      figures = render_with(*make(), scene, arguments);
    });
  } catch (const compositor::ServiceLost& lost) {
    throw std::runtime_error(fmt::format(
        "no image was rendered ({}); try again, or render in this process, without nodes", lost.what()));
  }
  figures.backends = backends;
  if (!arguments.report.empty()) write_render_report(arguments.report, figures);
  if (arguments.progress.quiet) return 0;
  for (const std::string& choice : backends) logging::log(logging::Level::info, "{}", choice);
  std::fputs(summary_text(figures).c_str(), stdout);
  return 0;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<RenderArguments>();
  CLI::App* render_command =
      app.add_subcommand("render", "renders an image of a volume file, without a viewer");
  add_scene_options(*render_command, arguments->scene);
  CLI::Option* const volume = render_command->get_option("VOLUME");
  volume->description(volume->get_description() +
                      "; or a scene that `understudy run --export` has saved (DIR/scene.json)");
  add_loading_nodes(*render_command, arguments->nodes);
  add_memory_option(
      *render_command, arguments->memory,
      "memory limit of each rank; larger volumes are loaded and rendered in parts, one after another");
  render_command->add_option("--out", arguments->out, "PNG file to write: the image over black")
      ->type_name("P.png")
      ->required()
      ->check(can_be_written(".png"));
  render_command
      ->add_option("--level", arguments->scene.level,
                   "level of detail of a hierarchical volume, with all samples (0), every 2nd (1), every 4th "
                   "(2), …, or of OME-Zarr, one of its levels; --step is then in samples of the level")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  render_command
      ->add_option("--save-float", arguments->save_float,
                   "PFM file for the image before it is rounded; F_alpha.pfm is written for its alpha channel")
      ->type_name("F.pfm")
      ->check(can_be_written(".pfm"));
  render_command->add_option("--report", arguments->report, "write the figures of this rendering as JSON")
      ->type_name("F.json")
      ->check(can_be_written());
  add_budget_options(*render_command, arguments->budget);
  render_command
      ->add_flag(
          "--error-bound", arguments->scene.error_bound,
          "print a certified bound of the error of the image; with --error, take the samples of a step at "
          "which this bound is within E, instead of measuring the error")
      ->excludes(render_command->get_option("--time"));
  render_command
      ->add_option("--frames", arguments->frames,
                   "number of times to render the image, to measure the frame time")
      ->check(CLI::Range(1, max_frames))
      ->capture_default_str();
  add_progress_options(*render_command, arguments->progress, ", with the bytes that each rank has read");
  render_command->callback([arguments, render_command, &chosen] {
    chosen = [arguments, render_command] { return render(*arguments, *render_command); };
  });
}

}  // namespace understudy::launcher
