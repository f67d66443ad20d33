// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/verifier.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "spu/volume/timing/milliseconds_since.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using Clock = std::chrono::steady_clock;

/// With the eye inside, rays of all directions begin at the eye: a step that is not known exactly has more
/// effect than from outside, and also in other views than the one that is compared.
constexpr double inside_psnr = 40;

}  // namespace

Refusal refusal_of(const Comparison& comparison) {
  const TileDifference& tile = comparison.difference.worst;
  return {fmt::format(
      "its image differs from the viewer's own in the {} x {} pixels at ({}, {}): by {:.1f}/255 on average "
      "beyond "
      "their neighbours ({:g}/255 are allowed), an eighth of them by {:.0f}/255 ({:g}/255)",
      tile.tile.width, tile.tile.height, tile.tile.x, tile.tile.y, 255 * tile.excess,
      comparison.bound * 255 * max_tile_excess, 255 * tile.common,
      comparison.bound * 255 * max_common_difference)};
}

bool Verifier::whole_due(const VerifiedVolume& volume, bool eye_inside, std::uint64_t frames) const {
  const Options& options = session_.options();
  if (options.verify < 0) return false;
  const bool due = options.verify > 0 && frames % std::uint64_t(options.verify) == 0;
  const bool first_inside = eye_inside && !volume.inside;
  return due || first_inside || volume.schedule.whole_due();
}

std::optional<Comparison> Verifier::verify(const ImageToVerify& what, const volume::ImageView& image,
                                           VerifiedVolume& volume, VolumeCounters& counters) {
  if (session_.options().verify < 0) return std::nullopt;
  const TimedShare timed(account_.clock(), &FrameShares::verification);
  return whole_due(volume, what.eye_inside, what.frames) ? compare_whole(what, image, volume, counters)
                                                         : compare_sentinels(what, image, volume, counters);
}

std::optional<Comparison> Verifier::compare_whole(const ImageToVerify& what, const volume::ImageView& image,
                                                  VerifiedVolume& volume, VolumeCounters& counters) {
  const Pipeline& pipeline = what.run.pipeline();
  const volume::Rect window = comparable(what.window, what.request.viewport);
  if (window.empty()) return std::nullopt;
  NativeDrawing drawing(context_, pipeline, what.request);
  if (!drawing.complete()) throw Refusal{"the driver offers no float framebuffer to compare images in"};
  if (!volume.schedule.native_ms()) drawing.compile(what.run, window, what.request.depth);
  const double native_ms = drawing.add_timed(what.run);
  NativeImage native = drawing.image(window);
  const ImageDifference difference = difference_between(pipeline, native, image);
  if (what.eye_inside && difference.psnr() < inside_psnr) {
    volume.left_inside = fmt::format(
        "seen from inside, its image differs from the application's own by {:.1f} dB", difference.psnr());
    throw Refusal{volume.left_inside, fmt::format("{:.0f} dB are needed", inside_psnr),
                  "move the eye out of the volume"};
  }
  volume.inside = what.eye_inside;
  const Comparison comparison = judge(difference, volume.schedule.bound(), native_ms, counters);
  if (!comparison.right) lost_to_ = {std::move(native), comparison.bound};
  return comparison;
}

bool Verifier::would_have_been_right(const Pipeline& pipeline, const volume::ImageView& image) const {
  return difference_between(pipeline, lost_to_.native, image).worst.within_bound(lost_to_.bound);
}

Comparison Verifier::judge(const ImageDifference& difference, double bound, double native_ms,
                           VolumeCounters& counters) {
  count(difference, counters);
  account_.note([&](FrameRecord& frame) { frame.error_rms = std::sqrt(difference.mean_square); });
  const double asked_psnr = session_.options().verify_psnr;
  const bool right = difference.worst.within_bound(bound) && !(difference.psnr() < asked_psnr);
  return {difference, bound, right, native_ms};
}

void Verifier::count(const ImageDifference& difference, VolumeCounters& counters) {
  counters.verify_max = std::max(counters.verify_max, difference.max);
  counters.verify_sum_sq += difference.mean_square;
  counters.verified_frames.fetch_add(1, std::memory_order_relaxed);
  if (difference.worst.severity() >= counters.verify_worst_tile) {
    counters.verify_worst_tile = difference.worst.severity();
    counters.verify_worst_frame = account_.frames() + 1;
  }
}

std::optional<Comparison> Verifier::judge_sentinel(const ImageDifference& difference,
                                                   VolumeCounters& counters) {
  counters.verified_tiles.fetch_add(1, std::memory_order_relaxed);
  if (difference.worst.severity() > counters.verify_worst_tile) {
    counters.verify_worst_tile = difference.worst.severity();
    counters.verify_worst_frame = account_.frames() + 1;
  }
  if (difference.worst.within_bound()) return std::nullopt;
  return Comparison{.difference = difference, .right = false, .native_ms = {}};
}

std::optional<Comparison> Verifier::compare_sentinels(const ImageToVerify& what, const volume::ImageView& image,
                                                      VerifiedVolume& volume, VolumeCounters& counters) {
  const int tiles = volume.schedule.sentinels();
  const volume::Rect window = comparable(what.window, what.request.viewport);
  if (tiles == 0 || window.empty()) return std::nullopt;
  NativeDrawing& drawing = sentinels_.drawing(context_, what.run.pipeline(), what.request);
  if (!drawing.complete()) return std::nullopt;
  const auto start = Clock::now();
  for (int i = 0; i < tiles; ++i) {
    const volume::Rect tile = sentinels_.next_tile(window);
    drawing.clear(tile, what.request.depth);
    drawing.add_within(what.run, tile);
    NativeImage native = drawing.image(tile);
    if (auto lost = judge_sentinel(difference_between(what.run.pipeline(), native, image), counters)) {
      lost_to_ = {std::move(native), 1};
      return lost;
    }
  }
  volume.schedule.sentinels_took(tiles, milliseconds_since(start));
  return std::nullopt;
}

}  // namespace understudy::spu
