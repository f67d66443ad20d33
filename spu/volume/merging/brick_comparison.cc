// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/brick_comparison.h"

#include <chrono>
#include <utility>

#include "spu/volume/depth/depth.h"
#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/timing/milliseconds_since.h"
#include "spu/volume/verification/tile_comparison.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

/// The error of an image within a budget is measured instead.
bool BrickComparison::has_budget() const {
  const auto lock = session_.lock();
  return session_.settings().has_budget();
}

void BrickComparison::begin(const MergedVolume& merged, const Run& run, const volume::RenderRequest& request) {
  end();
  const VerificationSchedule& schedule = merged.volume.verified.schedule;
  const bool whole = verifier_.whole_due(merged.volume.verified, false, merged.volume.frames);
  if (!whole && (schedule.sentinels() == 0 || has_budget())) return;
  const TimedShare timed(account_.clock(), &FrameShares::verification);
  const Pipeline& pipeline = run.pipeline();
  const volume::Rect window = comparable(request.window, request.viewport);
  if (window.empty()) return;
  const volume::Rect rect = whole ? window : sentinels_.next_tile(window);
  NativeDrawing& drawing = sentinels_.drawing(context_, pipeline, request);
  if (!drawing.complete()) throw Refusal{"the driver offers no float framebuffer to compare images in"};
  std::optional<volume::DepthImage> depth;
  if (pipeline.depth_test) depth = read_depth(context_, pipeline.target, rect, pipeline.depth_or_equal);
  drawing.clear(rect, depth);
  if (whole && !schedule.native_ms()) drawing.compile(run, window, depth);
  compared_ = {.drawing = &drawing, .rect = rect, .whole = whole};
}

void BrickComparison::add(const Run& run) {
  if (!compared_) return;
  const TimedShare timed(account_.clock(), &FrameShares::verification);
  if (compared_->whole) {
    compared_->ms += compared_->drawing->add_timed(run);
    return;
  }
  const auto start = Clock::now();
  compared_->drawing->add_within(run, compared_->rect);
  compared_->ms += milliseconds_since(start);
}

void BrickComparison::check(const Pipeline& pipeline, const volume::ImageView& image, KnownVolume& volume) {
  if (!compared_) return;
  const TimedShare timed(account_.clock(), &FrameShares::verification);
  VerificationSchedule& schedule = volume.verified.schedule;
  const auto start = Clock::now();
  NativeImage native = compared_->drawing->image(compared_->rect);
  const ImageDifference difference = difference_between(pipeline, native, image);
  std::optional<Comparison> comparison;
  if (compared_->whole) {
    comparison = verifier_.judge(difference, schedule.bound(), compared_->ms, *volume.counters);
    if (!comparison->right) shown_instead_ = std::move(native);
  } else {
    comparison = verifier_.judge_sentinel(difference, *volume.counters);
    schedule.sentinels_took(1, compared_->ms + milliseconds_since(start));
  }
  take_comparison(comparison, volume, account_.frames());
}

}  // namespace understudy::spu
