// SPDX-License-Identifier: Apache-2.0
// Asks a window to redraw itself, with the event that X sends to a window which has been uncovered (Expose);
// the program must then draw it. Used for windows whose latest image is one frame late
// (spu/volume/session/frame_latency.h), if no other frame follows by itself.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

namespace understudy::interceptor {

class RedrawRequest {
 public:
  /// `asked` is called, on another thread, each time a window has been asked.
  explicit RedrawRequest(std::function<void()> asked);
  ~RedrawRequest();
  RedrawRequest(const RedrawRequest&) = delete;
  RedrawRequest& operator=(const RedrawRequest&) = delete;

  /// Whether the window exists on the display named by DISPLAY, and the program itself uses X.
  bool can_ask(std::uintptr_t window);
  /// The window shows another frame, which cancels an earlier request. If the frame is `behind`, the window is
  /// asked to redraw once no other frame has come for a while.
  void frame_shown(std::uintptr_t window, bool behind);

 private:
  class Display;
  struct Due {
    std::uintptr_t window = 0;
    std::chrono::steady_clock::time_point at;
  };

  void ask_when_due();

  const std::function<void()> asked_;
  std::unique_ptr<Display> display_;
  std::uintptr_t known_window_ = 0;
  bool knows_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Due> due_;
  bool has_thread_ = false;
};

}  // namespace understudy::interceptor
