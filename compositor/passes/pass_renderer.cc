// SPDX-License-Identifier: Apache-2.0
#include "compositor/passes/pass_renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "compositor/blend.h"
#include "compositor/service/limits.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/file/volume_file.h"
#include "volume/footprint.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::compositor {

using volume::BrickStore;
using volume::RenderRequest;
using volume::TexelBox;

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Adds the figures of one part, by rank. `again`: it was loaded before, and its NaNs are counted already.
void add_part(std::vector<RankLoad>& all, std::span<const RankLoad> part, bool again) {
  all.resize(part.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    RankLoad& rank = all[i];
    const RankLoad& more = part[i];
    rank.texels_done += more.texels_done;
    rank.texels_in_all += more.texels_in_all;
    rank.bytes_read += more.bytes_read;
    rank.brick_bytes = std::max(rank.brick_bytes, more.brick_bytes);
    rank.peak_bytes = std::max(rank.peak_bytes, more.peak_bytes);
    if (more.low <= more.high) {
      rank.low = rank.low <= rank.high ? std::min(rank.low, more.low) : more.low;
      rank.high = std::max(rank.high, more.high);
    }
    rank.largest_error = std::max(rank.largest_error, more.largest_error);
    if (!again) rank.not_numbers += more.not_numbers;
    rank.cells = more.cells;
  }
}

/// Returns the texels for a range of values, in units of the texel type and widened to whole units; empty, as
/// `values` is, if low > high.
BrickStore::Range texels_between(const volume::TexelMapping& mapping, const std::array<double, 2>& values) {
  if (values[0] > values[1]) return {1, 0};
  const double unit = volume::largest_texel(mapping.type);
  const double a = mapping.normalised(values[0]) * unit, b = mapping.normalised(values[1]) * unit;
  if (mapping.type == volume::TexelType::f32) return {float(std::min(a, b)), float(std::max(a, b))};
  return {float(std::clamp(std::floor(std::min(a, b)), 0.0, unit)),
          float(std::clamp(std::ceil(std::max(a, b)), 0.0, unit))};
}

}  // namespace

PassRenderer::PassRenderer(LoadingService& service, const volume::VolumeFile& file, LoadRequest load,
                           const volume::Partition& parts, Progress progress)
    : service_(service),
      file_(file),
      load_(std::move(load)),
      parts_(load_.volume, parts),
      progress_(std::move(progress)),
      values_(std::size_t(parts.ranks), Values{1, 0}),
      known_(std::size_t(parts.ranks)) {
  figures_.passes = parts.ranks;
  ranks_.resize(std::size_t(std::max(1, service.nodes())));
}

void PassRenderer::load_part(int part) {
  if (loaded_ == part) return;
  loaded_.reset();
  if (parts_.ranks() > 1) load_.volume.part = parts_.box(part);
  std::vector<RankLoad> ranks = service_.begin_load(load_);
  progress_(part, parts_.ranks(), ranks);
  while (!std::ranges::all_of(ranks, &RankLoad::done)) {
    ranks = service_.continue_load(load_.volume.id);
    progress_(part, parts_.ranks(), ranks);
  }
  add_part(ranks_, ranks, known_[std::size_t(part)]);
  known_[std::size_t(part)] = true;
  loaded_ = part;
  ++figures_.loads;
  Values& values = values_[std::size_t(part)];
  values = {1, 0};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const RankLoad& rank : ranks) {
    if (std::isinf(rank.largest_error)) {  // infinite values, which are clamped, count for no range
      values = {-infinity, infinity};
      break;
    }
    if (rank.low > rank.high) continue;
    values = values[0] > values[1] ? Values{rank.low, rank.high}
                                   : Values{std::min(values[0], rank.low), std::max(values[1], rank.high)};
  }
}

void PassRenderer::load_for_image(int part) {
  const auto start = Clock::now();
  load_part(part);
  figures_.load_ms += milliseconds_since(start);
}

void PassRenderer::load(const RenderRequest& view) {
  std::vector<int> order = parts_.visibility_order(view);
  if (order.size() > 1 && file_.description().values) {
    for (const int part : order)
      if (const TexelBox& cells = parts_.box(part); !volume::is_empty(cells))
        values_[std::size_t(part)] = file_.values_in(BrickStore::texels_shown(load_.volume, cells))
                                         .value_or(*file_.description().values);
    return;
  }
  std::ranges::reverse(order);
  for (const int part : order)
    if (!volume::is_empty(parts_.box(part))) load_part(part);
}

bool PassRenderer::may_show(const RenderRequest& request, int part) const {
  const auto* const function = std::get_if<volume::TransferFunction>(&request.classification);
  if (function == nullptr || request.bound_of) return true;
  const volume::TexelMapping mapping = volume::mapping_of(file_.description(), load_.texels);
  BrickStore::Range texels = texels_between(mapping, values_[std::size_t(part)]);
  const volume::ScalarType type = file_.description().type;
  const bool floats = type == volume::ScalarType::f32 || type == volume::ScalarType::f64;
  if (floats && mapping.type != volume::TexelType::f32)  // NaN becomes the least integer
    texels = {0, texels.low <= texels.high ? texels.high : 0};
  // Under `min` any sample shows, even one of value 0.
  if (request.op == volume::Operator::min) return texels.low <= texels.high;
  const volume::TransferTable table(*function, mapping.type, volume::neutral_value(request.op));
  const double unit = volume::largest_texel(mapping.type);
  return table.shows(texels) || std::ranges::any_of(request.surfaces, [&](const volume::Surface& surface) {
           return texels.low <= surface.value * unit && surface.value * unit <= texels.high;
         });
}

std::optional<RenderRequest> PassRenderer::request_of_part(const RenderRequest& request,
                                                           const volume::Image& image, int part) const {
  const volume::Rect footprint =
      intersection(volume::footprint(request, load_.volume, parts_.box(part)), image.rect);
  RenderRequest of_part = request;
  of_part.window = footprint;
  const bool covers = request.op == volume::Operator::over || request.op == volume::Operator::first_hit;
  if (covers && !request.bound_of) {
    const float least = volume::least_transparency(request);
    of_part.window = {};
    for (int y = footprint.y; y < footprint.y + footprint.height; ++y)
      for (int x = footprint.x; x < footprint.x + footprint.width; ++x)
        if (1 - image.at(x, y)[3] >= least) of_part.window = bounding(of_part.window, {x, y, 1, 1});
  }
  if (of_part.window.empty()) return std::nullopt;
  return of_part;
}

void PassRenderer::add_image_figures() {
  const std::vector<RankLoad> ranks = service_.continue_load(load_.volume.id);
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    ranks_[i].peak_bytes = std::max(ranks_[i].peak_bytes, ranks[i].peak_bytes);
    ranks_[i].brick_bytes = std::max(ranks_[i].brick_bytes, ranks[i].brick_bytes);
    ranks_[i].image_ms += ranks[i].image_ms;
    ranks_[i].image_processor_ms += ranks[i].image_processor_ms;
    ranks_[i].image_samples += ranks[i].image_samples;
  }
}

std::vector<PassRenderer::Composite> PassRenderer::composites(std::span<const RenderRequest> requests) {
  if (requests.empty()) return {};
  volume::VolumeDescription whole = load_.volume;
  whole.part.reset();
  std::vector<Composite> composites;
  for (const RenderRequest& request : requests) {
    if (volume::needs_whole_rays(request))
      throw RequestRefused(
          "rays that end where they are opaque have to be cast whole: give more memory or nodes");
    volume::Image& image =
        composites.emplace_back(Composite{volume::Image(footprint(request, whole, shown_cells(whole))), {}})
            .image;
    std::ranges::fill(image.rgba, volume::neutral_value(request.op));
  }
  for (RankLoad& rank : ranks_) rank.image_ms = rank.image_processor_ms = 0, rank.image_samples = 0;
  for (const int part : parts_.visibility_order(requests.front())) {
    bool shows = false, reached = false;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      if (volume::is_empty(parts_.box(part)) || !may_show(requests[i], part)) continue;
      shows = true;
      const auto request = request_of_part(requests[i], composites[i].image, part);
      if (!request) continue;
      reached = true;
      load_for_image(part);
      const Rendered shown = service_.render(*request);
      blend(request->op, composites[i].image, shown.image);
      composites[i].counts += shown.counts;
      composites[i].lossy |= shown.lossy;
      add_image_figures();
    }
    if (!shows)
      ++figures_.empty;
    else if (!reached)
      ++figures_.hidden;
  }
  return composites;
}

Rendered PassRenderer::render(const RenderRequest& request) {
  if (parts_.ranks() == 1) return service_.render(request);
  Composite composite = std::move(composites({&request, 1}).front());
  image_ = std::move(composite.image);
  return {image_.view(), composite.counts, false, composite.lossy};
}

std::vector<volume::Image> PassRenderer::images(std::span<const RenderRequest> requests) {
  if (parts_.ranks() == 1) return service_.images(requests);
  std::vector<volume::Image> images;
  images.reserve(requests.size());
  for (Composite& composite : composites(requests)) images.push_back(std::move(composite.image));
  return images;
}

std::vector<volume::PixelIntegral> PassRenderer::integrals(const RenderRequest& request,
                                                           std::span<const volume::Pixel> pixels,
                                                           double most_ms) {
  if (parts_.ranks() == 1) return service_.integrals(request, pixels, most_ms);
  std::vector<volume::PixelIntegral> integrals(pixels.size());
  for (const int part : parts_.visibility_order(request)) {
    if (volume::is_empty(parts_.box(part)) || !may_show(request, part)) continue;
    load_for_image(part);
    for (std::size_t done = 0; done < pixels.size();) {
      const std::vector<volume::PixelIntegral> behind =
          service_.integrals(request, pixels.subspan(done), limits::max_integral_ms);
      if (behind.empty()) return {};
      for (std::size_t i = 0; i < behind.size(); ++i) {
        volume::PixelIntegral& front = integrals[done + i];
        const double clear = 1 - front[3];
        for (std::size_t k = 0; k < front.size(); ++k) front[k] += clear * behind[i][k];
      }
      done += behind.size();
    }
  }
  return integrals;
}

std::vector<RankLoad> PassRenderer::ranks() {
  return parts_.ranks() == 1 ? service_.continue_load(load_.volume.id) : ranks_;
}

}  // namespace understudy::compositor
