// SPDX-License-Identifier: Apache-2.0
// What each context of the process did since its last frame end. A context that draws into framebuffer objects
// and ends no frames draws for those that do (Qt's widgets have a context of their own, and are shown by
// another): its figures go to the next frame that ends anywhere.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>

#include "spu/report/counters.h"

namespace understudy::spu {

/// Safe from any thread.
class FrameLedger {
 public:
  /// Stands for one context; a pointer to compare, never followed.
  using Context = const void*;

  /// Calls `change` on what `context` did so far. What it draws into its window it will show itself.
  template <class Change>
  void note(Context context, bool into_window, Change change) {
    const std::scoped_lock lock(mutex_);
    Page& page = pages_[context];
    page.ends_frames |= into_window;
    change(page.record);
  }
  /// The same for whatever belongs to no context: it goes to the next frame that ends anywhere.
  template <class Change>
  void note(Change change) {
    const std::scoped_lock lock(mutex_);
    change(left_behind_);
  }
  /// `context` ends a frame: what belongs to it, everything but its time.
  FrameRecord close(Context context);
  /// The context is gone; what it drew is not.
  void forget(Context context);

  /// Frames ended so far, in all contexts.
  std::uint64_t frames() const;

 private:
  struct Page {
    FrameRecord record{.error_rms = -1};
    bool ends_frames = false;
  };

  mutable std::mutex mutex_;
  std::map<Context, Page> pages_;
  FrameRecord left_behind_{.error_rms = -1};  ///< by contexts that are gone, or by none
  std::uint64_t frames_ = 0;
};

}  // namespace understudy::spu
