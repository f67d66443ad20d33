// SPDX-License-Identifier: Apache-2.0
#include "interceptor/core/redraw_request.h"

#include <dlfcn.h>
#include <xcb/xcb.h>

#include <cstdlib>
#include <exception>
#include <thread>
#include <utility>

#include "compositor/service/blocked_signals.h"

namespace understudy::interceptor {
namespace {

/// Longer than the time of a frame while somebody turns the camera.
constexpr std::chrono::milliseconds pause_before_asking{60};

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

RedrawRequest::RedrawRequest(std::function<void()> asked) : asked_(std::move(asked)) {}
RedrawRequest::~RedrawRequest() = default;

bool RedrawRequest::can_ask(std::uintptr_t window) {
  const std::lock_guard lock(mutex_);
  if (window == 0) return false;
  if (window != known_window_) {
    known_window_ = window;
    if (display_ == nullptr) display_ = Display::open();
    knows_ = display_ != nullptr && display_->has(window);
  }
  return knows_;
}

void RedrawRequest::frame_shown(std::uintptr_t window, bool behind) {
  const std::lock_guard lock(mutex_);
  if (due_ && due_->window == window) due_.reset();
  if (!behind) return;
  due_ = {window, std::chrono::steady_clock::now() + pause_before_asking};
  // The thread sleeps until the program exits, and touches nothing that is torn down at exit.
  if (!has_thread_) {
    const compositor::BlockedSignals blocked;
    std::thread([this] {
      try {
        ask_when_due();
      } catch (const std::exception&) {
        // No more requests: an image that is behind stays so until the program draws.
      }
    }).detach();
    has_thread_ = true;
  }
  changed_.notify_one();
}

void RedrawRequest::ask_when_due() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!due_) {
      changed_.wait(lock);
    } else if (std::chrono::steady_clock::now() < due_->at) {
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(due_->at));
    } else if (!display_->expose(due_->window)) {
      due_.reset();
    } else {
      // Busy programs may discard events, so the request is repeated until the program draws.
      due_->at = std::chrono::steady_clock::now() + 16 * pause_before_asking;
      asked_();
    }
  }
}

}  // namespace understudy::interceptor
