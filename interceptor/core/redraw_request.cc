// SPDX-License-Identifier: Apache-2.0
#include "interceptor/core/redraw_request.h"

#include <dlfcn.h>
#include <xcb/xcb.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <thread>
#include <utility>

#include "compositor/service/blocked_signals.h"

namespace understudy::interceptor {
namespace {

/// Longer than the time of a frame while somebody turns the camera.
constexpr std::chrono::milliseconds pause_before_asking{60};
constexpr std::size_t most_known_windows = 64;

template <class Function>
Function* function(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

}  // namespace

/// A connection of our own, so that the program's threads cannot block it. Uses the libxcb that the program's
/// Xlib has already opened.
class RedrawRequest::Display {
 public:
  static std::unique_ptr<Display> open() {
    void* const library = dlopen("libxcb.so.1", RTLD_NOW | RTLD_NOLOAD);
    if (library == nullptr) return nullptr;
    std::unique_ptr<Display> display(new Display(library));
    if (!display->is_complete()) return nullptr;
    display->connection_ = display->connect_(nullptr, nullptr);
    return display->has_error_(display->connection_) == 0 ? std::move(display) : nullptr;
  }
  ~Display() {
    if (connection_ != nullptr) disconnect_(connection_);
  }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  bool has(std::uintptr_t window) {
    xcb_generic_error_t* error = nullptr;
    xcb_get_window_attributes_reply_t* const attributes =
        attributes_reply_(connection_, attributes_(connection_, xcb_window_t(window)), &error);
    std::free(error);
    const bool there = attributes != nullptr;
    std::free(attributes);
    return there;
  }

  /// False if the window no longer exists.
  bool expose(std::uintptr_t window) {
    xcb_generic_error_t* error = nullptr;
    xcb_get_geometry_reply_t* const geometry =
        geometry_reply_(connection_, geometry_(connection_, xcb_drawable_t(window)), &error);
    std::free(error);
    if (geometry == nullptr) return false;
    // xcb_send_event always reads 32 bytes, the size of any event.
    union {
      xcb_expose_event_t event;
      char bytes[32];
    } message{};
    message.event.response_type = XCB_EXPOSE;
    message.event.window = xcb_window_t(window);
    message.event.width = geometry->width;
    message.event.height = geometry->height;
    std::free(geometry);
    // With propagation: goes to whoever selected Expose on the window or on one of its parents.
    send_event_(connection_, 1, xcb_window_t(window), XCB_EVENT_MASK_EXPOSURE, message.bytes);
    flush_(connection_);
    return true;
  }

 private:
  explicit Display(void* library)
      : connect_(function<decltype(xcb_connect)>(library, "xcb_connect")),
        has_error_(function<decltype(xcb_connection_has_error)>(library, "xcb_connection_has_error")),
        disconnect_(function<decltype(xcb_disconnect)>(library, "xcb_disconnect")),
        attributes_(function<decltype(xcb_get_window_attributes)>(library, "xcb_get_window_attributes")),
        attributes_reply_(
            function<decltype(xcb_get_window_attributes_reply)>(library, "xcb_get_window_attributes_reply")),
        geometry_(function<decltype(xcb_get_geometry)>(library, "xcb_get_geometry")),
        geometry_reply_(function<decltype(xcb_get_geometry_reply)>(library, "xcb_get_geometry_reply")),
        send_event_(function<decltype(xcb_send_event)>(library, "xcb_send_event")),
        flush_(function<decltype(xcb_flush)>(library, "xcb_flush")) {}

  bool is_complete() const {
    return connect_ != nullptr && has_error_ != nullptr && disconnect_ != nullptr && attributes_ != nullptr &&
           attributes_reply_ != nullptr && geometry_ != nullptr && geometry_reply_ != nullptr &&
           send_event_ != nullptr && flush_ != nullptr;
  }

  decltype(xcb_connect)* connect_;
  decltype(xcb_connection_has_error)* has_error_;
  decltype(xcb_disconnect)* disconnect_;
  decltype(xcb_get_window_attributes)* attributes_;
  decltype(xcb_get_window_attributes_reply)* attributes_reply_;
  decltype(xcb_get_geometry)* geometry_;
  decltype(xcb_get_geometry_reply)* geometry_reply_;
  decltype(xcb_send_event)* send_event_;
  decltype(xcb_flush)* flush_;
  xcb_connection_t* connection_ = nullptr;
};

RedrawRequest::RedrawRequest(std::function<void(std::uintptr_t)> asked) : asked_(std::move(asked)) {}
RedrawRequest::~RedrawRequest() = default;

bool RedrawRequest::can_ask(std::uintptr_t window) {
  const std::lock_guard lock(mutex_);
  if (window == 0) return false;
  const auto known = std::ranges::find(known_, window, &KnownWindow::window);
  if (known != known_.end()) return known->can_be_asked;
  if (display_ == nullptr) display_ = Display::open();
  if (known_.size() == most_known_windows) known_.erase(known_.begin());
  known_.push_back({window, display_ != nullptr && display_->has(window)});
  return known_.back().can_be_asked;
}

void RedrawRequest::frame_shown(std::uintptr_t window, spu::LateViews late) {
  const std::lock_guard lock(mutex_);
  const auto due = std::ranges::find(due_, window, &Due::window);
  if (late == spu::LateViews::none) {
    if (due != due_.end()) due_.erase(due);
    return;
  }
  const auto at = std::chrono::steady_clock::now() + pause_before_asking;
  if (due == due_.end()) {
    due_.push_back({window, at});
  } else if (late == spu::LateViews::of_this_frame) {
    due->at = at;
  }
  start_thread();
  changed_.notify_one();
}

void RedrawRequest::start_thread() {
  if (std::exchange(has_thread_, true)) return;
  const compositor::BlockedSignals blocked;
  // The thread sleeps until the program exits, and touches nothing that is torn down at exit.
  std::thread([this] {
    try {
      ask_when_due();
    } catch (const std::exception&) {
      // No more requests: an image that is late stays so until the program draws.
    }
  }).detach();
}

void RedrawRequest::ask_when_due() {
  std::unique_lock lock(mutex_);
  for (;;) {
    ask_those_due();
    if (due_.empty()) {
      changed_.wait(lock);
    } else {
      const auto next = std::ranges::min(due_, {}, &Due::at).at;
      changed_.wait_until(lock, next);
    }
  }
}

void RedrawRequest::ask_those_due() {
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(due_, [&](Due& due) {
    if (now < due.at) return false;
    if (!display_->expose(due.window)) return true;
    // Busy programs may discard events, so the request is repeated until the program draws.
    due.at = now + 16 * pause_before_asking;
    asked_(due.window);
    return false;
  });
}

}  // namespace understudy::interceptor
