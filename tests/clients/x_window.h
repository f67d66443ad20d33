// SPDX-License-Identifier: Apache-2.0
// A window with an OpenGL context (GLX), for programs that tests run.
#pragma once

#include <GL/glx.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

namespace client {

constexpr int window_size = 128;  ///< width and height

enum class Buffers { one, two };

class XWindow {
 public:
  explicit XWindow(Buffers buffers) : display_(XOpenDisplay(nullptr)) {
    int wanted[] = {GLX_RGBA, GLX_RED_SIZE, 8, GLX_GREEN_SIZE, 8, GLX_BLUE_SIZE, 8, None, None};
    if (buffers == Buffers::two) wanted[7] = GLX_DOUBLEBUFFER;
    XVisualInfo* const visual =
        display_ == nullptr ? nullptr : glXChooseVisual(display_, DefaultScreen(display_), wanted);
    if (visual == nullptr) give_up("glXChooseVisual");
    const Window root = RootWindow(display_, visual->screen);
    XSetWindowAttributes attributes{};
    attributes.colormap = XCreateColormap(display_, root, visual->visual, AllocNone);
    attributes.event_mask = ExposureMask;
    window_ = XCreateWindow(display_, root, 0, 0, window_size, window_size, 0, visual->depth, InputOutput,
                            visual->visual, CWColormap | CWEventMask, &attributes);
    XMapWindow(display_, window_);
    XEvent event;
    XWindowEvent(display_, window_, ExposureMask, &event);
    context_ = glXCreateContext(display_, visual, nullptr, True);
    if (context_ == nullptr || !glXMakeCurrent(display_, window_, context_)) give_up("glXMakeCurrent");
  }
  XWindow(const XWindow&) = delete;
  XWindow& operator=(const XWindow&) = delete;

  Display* display() const { return display_; }
  void swap() const { glXSwapBuffers(display_, window_); }
  void release() const { glXMakeCurrent(display_, None, nullptr); }

  /// Waits until the program is ended from outside.
  [[noreturn]] static void rest() {
    puts("drawn");
    fflush(stdout);
    for (;;) pause();
  }

 private:
  [[noreturn]] static void give_up(const char* what) {
    printf("%s fails\n", what);
    exit(3);
  }

  Display* display_;
  Window window_ = None;
  GLXContext context_ = nullptr;
};

}  // namespace client
