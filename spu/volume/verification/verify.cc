// The volume unit's comparisons with what the application itself would draw: whole images, and sentinels.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "spu/volume/substitution.h"
#include "spu/volume/verification/tile_comparison.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::spu {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Rays of all directions begin at the eye: a step that is not quite known shows more than from outside, and in
/// other views than the one that is compared.
constexpr double inside_psnr = 40;

/// Neighbours of a sentinel's pixels are compared with, too.
constexpr int sentinel_rim = 1;

/// Frames until a volume is tried again, by lost comparisons in a row.
constexpr std::array<std::uint64_t, 4> pauses = {1, 1, 4, 16};

std::string sentence_of(const ImageDifference& difference) {
  const TileDifference& tile = difference.worst;
  return fmt::format(
      "its image differs from the viewer's own in the {} x {} pixels at ({}, {}): by {:.1f}/255 on average "
      "beyond "
      "their neighbours ({:.0f}/255 are allowed), an eighth of them by {:.0f}/255 ({:.0f}/255)",
      tile.tile.width, tile.tile.height, tile.tile.x, tile.tile.y, 255 * tile.excess, 255 * max_tile_excess,
      255 * tile.common, 255 * max_common_difference);
}

}  // namespace

bool VolumeUnit::to_be_verified(const Substitution& s) const {
  const Options& options = session_->options();
  if (options.verify < 0) return false;
  const bool due = options.verify > 0 && s.volume.frames % std::uint64_t(options.verify) == 0;
  const bool first_inside = s.eye_inside && !s.volume.verified_inside;
  return due || first_inside || s.volume.verification.whole_due();
}

void VolumeUnit::verify(Substitution& s, const volume::ImageView& image) {
  if (session_->options().verify < 0) return;
  const TimedShare timed(clock_, &FrameShares::verification);
  if (to_be_verified(s)) {
    compare_whole(s, image);
  } else {
    compare_sentinels(s, image);
  }
}

void VolumeUnit::compare_whole(Substitution& s, const volume::ImageView& image) {
  const volume::Rect window = intersection(s.request.window, s.request.viewport);
  if (window.empty()) return;
  NativeDrawing drawing(context(), s.pipeline, s.request);
  if (!drawing.complete()) return;
  const double native_ms = drawing.add_timed(s.run);
  const ImageDifference difference = difference_between(s.pipeline, drawing.image(window), image);
  if (s.eye_inside && difference.psnr() < inside_psnr) {
    s.volume.left_inside = fmt::format(
        "seen from inside, its image differs from the application's own by {:.1f} dB", difference.psnr());
    throw Refusal{s.volume.left_inside};
  }
  s.volume.verified_inside = s.eye_inside;
  judge(s.volume, difference, native_ms);
}

void VolumeUnit::judge(KnownVolume& known, const ImageDifference& difference, double native_ms) {
  count_difference(known, difference);
  note([&](FrameRecord& frame) { frame.error_rms = std::sqrt(difference.mean_square); });
  const double asked_psnr = session_->options().verify_psnr;
  if (!difference.worst.within_bound() || difference.psnr() < asked_psnr) lose(known, difference);
  if (difference.anything_visible) known.sample_rounding.won();
  known.verification.whole_was_right(difference.anything_visible, native_ms);
}

void VolumeUnit::count_difference(KnownVolume& known, const ImageDifference& difference) {
  VolumeCounters& counters = *known.counters;
  counters.verify_max = std::max(counters.verify_max, difference.max);
  counters.verify_sum_sq += difference.mean_square;
  counters.verified_frames.fetch_add(1, std::memory_order_relaxed);
  if (difference.worst.severity() >= counters.verify_worst_tile) {
    counters.verify_worst_tile = difference.worst.severity();
    counters.verify_worst_frame = session_->ledger().frames() + 1;
  }
}

void VolumeUnit::lose(KnownVolume& known, const ImageDifference& difference) {
  if (known.sample_rounding.try_after_loss(known.texture)) {
    known.next_try = session_->ledger().frames() + 1;
    known.verification.ask_for_whole();
    constexpr const char* next = "; tried again with samples rounded to 8 bits";
    throw Refusal{sentence_of(difference) + next};
  }
  known.verification.lost();
  known.counters->verify_lost.fetch_add(1, std::memory_order_relaxed);
  known.probed.reset();
  known.march.reset();
  const auto in_a_row = std::min(std::size_t(known.verification.lost_in_a_row()), pauses.size());
  known.next_try = session_->ledger().frames() + pauses[in_a_row - 1];
  const std::string reason = sentence_of(difference);
  if (known.verification.gives_up()) known.handed_back = reason;
  throw Refusal{reason};
}

NativeDrawing& VolumeUnit::sentinel_drawing(const Substitution& s) {
  const volume::Rect& viewport = s.request.viewport;
  const bool white = s.pipeline.blending.op == volume::Operator::min;
  const std::array<int, 4> extent{viewport.x + viewport.width, viewport.y + viewport.height,
                                  s.pipeline.target.samples, white ? 1 : 0};
  if (!sentinel_drawing_ || sentinel_extent_ != extent) {
    sentinel_drawing_ = std::make_unique<NativeDrawing>(context(), s.pipeline, s.request);
    sentinel_extent_ = extent;
  }
  return *sentinel_drawing_;
}

void VolumeUnit::compare_sentinels(Substitution& s, const volume::ImageView& image) {
  VerificationSchedule& schedule = s.volume.verification;
  const int count = schedule.sentinels();
  const volume::Rect window = intersection(s.request.window, s.request.viewport);
  if (count == 0 || window.empty()) return;
  NativeDrawing& drawing = sentinel_drawing(s);
  if (!drawing.complete()) return;
  const auto start = Clock::now();
  for (int i = 0; i < count; ++i) {
    const auto place = [&](int low, int extent) {
      return low + std::uniform_int_distribution<int>(0, std::max(extent - compared_tile_edge, 0))(random_);
    };
    const volume::Rect tile = intersection(
        window, {place(window.x, window.width) - sentinel_rim, place(window.y, window.height) - sentinel_rim,
                 compared_tile_edge + 2 * sentinel_rim, compared_tile_edge + 2 * sentinel_rim});
    drawing.redraw(s.run, tile, s.request.depth);
    const ImageDifference difference = difference_between(s.pipeline, drawing.image(tile), image);
    s.volume.counters->verified_tiles.fetch_add(1, std::memory_order_relaxed);
    if (difference.worst.severity() > s.volume.counters->verify_worst_tile) {
      s.volume.counters->verify_worst_tile = difference.worst.severity();
      s.volume.counters->verify_worst_frame = session_->ledger().frames() + 1;
    }
    if (!difference.worst.within_bound()) lose(s.volume, difference);
  }
  schedule.sentinels_took(count, milliseconds_since(start));
}

}  // namespace understudy::spu
