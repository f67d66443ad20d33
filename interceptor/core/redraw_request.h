// SPDX-License-Identifier: Apache-2.0
// Asks windows to redraw themselves, with the event that X sends to a window which has been uncovered (Expose);
// the program must then draw it. Used for windows with views whose image is one frame late
// (spu/volume/session/frame_latency.h), if these are not drawn again by themselves.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "spu/volume/views/shown_windows.h"

namespace understudy::interceptor {

class RedrawRequest {
 public:
  /// `asked` is called, on another thread, each time a window has been asked. It must not call this object.
  explicit RedrawRequest(std::function<void(std::uintptr_t window)> asked);
  ~RedrawRequest();
  RedrawRequest(const RedrawRequest&) = delete;
  RedrawRequest& operator=(const RedrawRequest&) = delete;

  /// Whether the window exists on the display named by DISPLAY, and the program itself uses X.
  bool can_ask(std::uintptr_t window);
  /// The window, which can be asked, shows another frame. If it has late views, it is asked to redraw once none
  /// of them has been drawn for a while; otherwise an earlier request is cancelled.
  void frame_shown(std::uintptr_t window, spu::LateViews late);

 private:
  class Display;
  struct KnownWindow {
    std::uintptr_t window;
    bool can_be_asked;
  };
  struct Due {
    std::uintptr_t window;
    std::chrono::steady_clock::time_point at;
  };

  void start_thread();
  void ask_when_due();
  void ask_those_due();

  const std::function<void(std::uintptr_t)> asked_;
  std::unique_ptr<Display> display_;
  std::vector<KnownWindow> known_;  ///< the latest last
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Due> due_;  ///< one for each window
  bool has_thread_ = false;
};

}  // namespace understudy::interceptor
