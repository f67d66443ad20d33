// SPDX-License-Identifier: Apache-2.0
// Records what each context of the process did since its last frame end. A context that draws into framebuffer
// objects and ends no frames draws for contexts that do (Qt's widgets have a context of their own, and are
// shown by another): its figures go to the next frame that ends anywhere.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>

#include "spu/report/counters.h"

namespace understudy::spu {

/// Thread-safe.
class FrameLedger {
 public:
  /// Identifies one context; a pointer that is compared, never dereferenced.
  using Context = const void*;

  /// Calls `change` on the record of `context`. A context that draws into its window ends frames itself.
  template <class Change>
  void note(Context context, bool into_window, Change change) {
    const std::scoped_lock lock(mutex_);
    Page& page = pages_[context];
    page.ends_frames |= into_window;
    change(page.record);
  }
  /// The same for work that belongs to no context: it goes to the next frame that ends anywhere.
  template <class Change>
  void note(Change change) {
    const std::scoped_lock lock(mutex_);
    change(left_behind_);
  }
  /// Called when `context` ends a frame. Returns all that belongs to the frame, except its time.
  FrameRecord close(Context context);
  /// Called when the context is gone: what it drew goes to the next frame.
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
  FrameRecord left_behind_{.error_rms = -1};  ///< of contexts that are gone, or of none
  std::uint64_t frames_ = 0;
};

}  // namespace understudy::spu
