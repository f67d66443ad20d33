// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/frame_ledger.h"

#include <algorithm>
#include <utility>

namespace understudy::spu {
namespace {

constexpr FrameRecord nothing_yet{.error_rms = -1};

void add(FrameRecord& sum, const FrameRecord& more) {
  sum.spent_ms += more.spent_ms;
  sum.substituted += more.substituted;
  sum.left += more.left;
  sum.within_budget += more.within_budget;
  sum.error_rms = std::max(sum.error_rms, more.error_rms);
  sum.counts += more.counts;
  sum.amounts += more.amounts;
}

}  // namespace

FrameRecord FrameLedger::close(Context context) {
  const std::scoped_lock lock(mutex_);
  ++frames_;
  Page& own = pages_[context];
  own.ends_frames = true;
  FrameRecord sum = std::exchange(own.record, nothing_yet);
  add(sum, std::exchange(left_behind_, nothing_yet));
  for (auto& [other, page] : pages_) {
    if (!page.ends_frames) add(sum, std::exchange(page.record, nothing_yet));
  }
  return sum;
}

void FrameLedger::forget(Context context) {
  const std::scoped_lock lock(mutex_);
  const auto page = pages_.find(context);
  if (page == pages_.end()) return;
  add(left_behind_, page->second.record);
  pages_.erase(page);
}

std::uint64_t FrameLedger::frames() const {
  const std::scoped_lock lock(mutex_);
  return frames_;
}

}  // namespace understudy::spu
