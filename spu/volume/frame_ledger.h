// What each context of the process did since its last frame end. A context that ends no frames draws for those
// that do (Qt's widgets are drawn into a framebuffer object in a context of their own, and shown by another):
// its figures go to the next frame that ends anywhere.
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

  /// Calls `change` on what `context` did so far.
  template <class Change>
  void note(Context context, Change change) {
    const std::scoped_lock lock(mutex_);
    change(pages_[context].record);
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
  FrameRecord left_behind_{.error_rms = -1};  ///< by contexts that are gone
  std::uint64_t frames_ = 0;
};

}  // namespace understudy::spu
