// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/configs.h"

#include <pthread.h>
#include <stdlib.h>

#include <initializer_list>

#include "interceptor/remote/x_server.h"

namespace understudy::interceptor {
namespace {

constexpr int most_configs = 24;  ///< 8 for each of: 24 bits without and with alpha, 32 bits with alpha

struct Screen {
  Display* display;
  int number;
  RemoteConfig configs[most_configs];
  int count;
  Screen* next;
};

constinit pthread_mutex_t configs_lock = PTHREAD_MUTEX_INITIALIZER;
constinit Screen* screens = nullptr;

bool takes_images(const XVisualInfo& visual) {
  return visual.c_class == TrueColor && visual.red_mask == 0xff0000 && visual.green_mask == 0xff00 &&
         visual.blue_mask == 0xff;
}

void add_visual(Screen& screen, VisualID visual, int depth, int alpha) {
  for (const int samples : {0, 4}) {
    for (const int with_depth : {1, 0}) {
      for (const int double_buffered : {1, 0}) {
        if (screen.count == most_configs) return;
        RemoteConfig& config = screen.configs[screen.count++];
        config = {screen.count,    screen.number,   visual,         depth,  alpha,
                  double_buffered, with_depth * 24, with_depth * 8, samples};
      }
    }
  }
}

void fill(Screen& screen) {
  if (screen.display == nullptr) {
    add_visual(screen, 0, 0, 0);
    add_visual(screen, 0, 0, 8);
    return;
  }
  const Xlib* x = xlib();
  if (x == nullptr) return;
  XVisualInfo wanted{};
  wanted.screen = screen.number;
  int count = 0;
  XVisualInfo* visuals = x->get_visual_info(screen.display, VisualScreenMask, &wanted, &count);
  if (visuals == nullptr) return;
  const VisualID usual = DefaultVisual(screen.display, screen.number)->visualid;
  for (const int depth : {24, 32}) {
    const XVisualInfo* best = nullptr;
    for (int i = 0; i < count; ++i) {
      if (visuals[i].depth != depth || !takes_images(visuals[i])) continue;
      if (best == nullptr || visuals[i].visualid == usual) best = &visuals[i];
    }
    // Toolkits that do not request alpha would take a 32-bit visual for a translucent window.
    if (best != nullptr && depth == 24) add_visual(screen, best->visualid, depth, 0);
    if (best != nullptr) add_visual(screen, best->visualid, depth, 8);
  }
  x->free(visuals);
}

}  // namespace

const RemoteConfig* remote_configs(Display* display, int screen, int* count) {
  pthread_mutex_lock(&configs_lock);
  Screen* found = screens;
  while (found != nullptr && (found->display != display || found->number != screen)) found = found->next;
  if (found == nullptr) {
    found = static_cast<Screen*>(calloc(1, sizeof(Screen)));
    if (found != nullptr) {
      found->display = display;
      found->number = screen;
      found->next = screens;
      screens = found;
      fill(*found);
    }
  }
  pthread_mutex_unlock(&configs_lock);
  *count = found != nullptr ? found->count : 0;
  return *count > 0 ? found->configs : nullptr;
}

XVisualInfo* visual_of(Display* display, const RemoteConfig& config) {
  const Xlib* x = xlib();
  if (x == nullptr) return nullptr;
  XVisualInfo wanted{};
  wanted.visualid = config.visual;
  wanted.screen = config.screen;
  int count = 0;
  return x->get_visual_info(display, VisualIDMask | VisualScreenMask, &wanted, &count);
}

}  // namespace understudy::interceptor
