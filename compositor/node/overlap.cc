// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/overlap.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <utility>

namespace understudy::compositor {

namespace {

using volume::Image;
using volume::Rect;

// What every rank tells every other about its part of a band.
struct BandOutcome {
  bool refused = false;
  Rect footprint;
};

std::vector<BandOutcome> agree(Communicator& communicator, BandOutcome mine) {
  std::vector<BandOutcome> outcomes(std::size_t(communicator.size()));
  communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(outcomes)));
  return outcomes;
}

// Returns the rows of a band in the image buffer, which holds `whole`.
ImageBuffers::Memory rows_of(const ImageBuffers::Memory& memory, const Rect& whole, const Rect& band) {
  ImageBuffers::Memory rows = memory;
  rows.floats = 4 * band.pixels();
  if (!memory.here.empty())
    rows.here = memory.here.subspan(4 * std::size_t(band.y - whole.y) * std::size_t(whole.width), rows.floats);
  return rows;
}

}  // namespace

std::vector<Rect> bands_of(const Rect& rect) {
  constexpr std::size_t most_bands = 8;
  constexpr std::size_t least_pixels = std::size_t(1) << 16;
  constexpr int rows_at_once = 16;
  if (rect.empty()) return {rect};
  const auto count = int(std::clamp<std::size_t>(rect.pixels() / least_pixels, 1, most_bands));
  const int rows = (rect.height + count - 1) / count;
  const int height = (rows + rows_at_once - 1) / rows_at_once * rows_at_once;
  std::vector<Rect> bands;
  for (int y = 0; y < rect.height; y += height)
    bands.push_back({rect.x, rect.y + y, rect.width, std::min(height, rect.height - y)});
  return bands;
}

bool draw_and_composite(Communicator& communicator, Compositing& compositing, const ImageTask& task,
                        const ImageBuffers::Memory& memory, const Rect& whole,
                        const std::function<std::optional<Image>(const Rect& band)>& draw,
                        volume::FrameCounts& travelled) {
  const bool has_room = 4 * whole.pixels() <= memory.floats;
  std::atomic<bool> given_up = false;
  const auto composite = [&](const Rect& band, std::optional<Image> drawn) {
    if (given_up) return;
    const std::vector<BandOutcome> outcomes =
        agree(communicator, {!drawn.has_value(), drawn ? drawn->rect : Rect{}});
    if (std::ranges::any_of(outcomes, &BandOutcome::refused)) {
      given_up = true;
      return;
    }
    std::vector<Rect> footprints;
    footprints.reserve(outcomes.size());
    for (const BandOutcome& outcome : outcomes) footprints.push_back(outcome.footprint);
    compositing.composite(task, std::move(*drawn), footprints, rows_of(memory, whole, band), travelled, band);
  };

  std::future<void> composited;
  for (const Rect& band : bands_of(whole)) {
    if (given_up) break;
    composited = std::async(std::launch::async, [&composite, band, drawn = has_room ? draw(band) : std::nullopt,
                                                 before = std::move(composited)]() mutable {
      if (before.valid()) before.get();
      composite(band, std::move(drawn));
    });
  }
  if (composited.valid()) composited.get();
  return !given_up;
}

void refuse_to_draw(Communicator& communicator) {
  agree(communicator, {true, {}});
}

bool OverlapChoice::next() const {
  constexpr double least_share = 0.05;
  constexpr int try_again_after = 64;
  if (wish_ != Overlap::automatic) return wish_ == Overlap::on;
  if (!apart_.seconds_per_sample || composite_share_ < least_share) return false;
  if (!overlapped_.seconds_per_sample) return true;
  if (apart_.images_ago >= try_again_after) return false;
  if (overlapped_.images_ago >= try_again_after) return true;
  return *overlapped_.seconds_per_sample < *apart_.seconds_per_sample;
}

void OverlapChoice::took(bool overlapped, std::uint64_t samples, double seconds, double composite_seconds) {
  if (samples == 0) return;
  constexpr double weight_of_latest = 0.5;
  Way& taken = overlapped ? overlapped_ : apart_;
  Way& other = overlapped ? apart_ : overlapped_;
  const double latest = seconds / double(samples);
  const double before = taken.seconds_per_sample.value_or(latest);
  taken.seconds_per_sample = before + weight_of_latest * (latest - before);
  taken.images_ago = 0;
  ++other.images_ago;
  if (!overlapped) composite_share_ = composite_seconds / seconds;
}

}  // namespace understudy::compositor
