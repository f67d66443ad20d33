// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/scene_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "apps/understudy/cli/render_report.h"
#include "spu/report/volume_report.h"
#include "volume/cell_lattice.h"
#include "volume/footprint.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

double largest_component(const volume::RenderRequest& request) {
  double largest = 0;
  for (const double component : request.steps->metric) largest = std::max(largest, std::abs(component));
  return largest;
}

}  // namespace

SceneFrames::SceneFrames(compositor::ImageService& service, const volume::VolumeDescription& volume,
                         const volume::RenderRequest& own, const spu::BudgetAsked& asked)
    : service_(service), volume_(volume), own_(own) {
  if (asked.any()) budget_.emplace(asked);
}

bool SceneFrames::choose_samples(RenderFigures& figures) {
  if (volume::footprint(own_, volume_, volume::shown_cells(volume_)).empty()) return false;
  const std::string obstacle =
      !own_.surfaces.empty() || own_.light ? "no integral is defined for surfaces and light" : "";
  const auto request = budget_->request(service_, own_, obstacle, volume_, 0, figures.budget);
  if (!request)
    throw std::invalid_argument(
        fmt::format("{}; leave out --error and --time", spu::text_in(figures.budget.note)));
  figures.step *= largest_component(figures.request) / largest_component(*request);
  figures.request = *request;
  return true;
}

compositor::Rendered SceneFrames::next(RenderFigures& figures) {
  // Each turn is finer than the one before: a budget that can be kept is reached in fewer turns.
  constexpr int most_turns = 8;
  for (int turn = 1;; ++turn) {
    const bool chosen = budget_ && choose_samples(figures);
    const auto start = Clock::now();
    compositor::Rendered rendered = service_.render(figures.request);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    const std::uint64_t over = figures.budget.images_over;
    if (chosen && !looks_) figures.budget.ms = ms;
    if (chosen && looks_) budget_->look_at(service_, rendered.image, ms, figures.budget);
    if (figures.budget.images_over > over && turn < most_turns) continue;
    figures.frame_ms.push_back(ms);
    figures.counts = rendered.counts;
    return rendered;
  }
}

}  // namespace understudy::launcher
