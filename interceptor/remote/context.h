// SPDX-License-Identifier: Apache-2.0
// Contexts of remote GLX and EGL: what was asked for, and which thread has which. What they draw with is the
// GL server's.
#pragma once

#include <cstdint>

#include "interceptor/core.h"
#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

constexpr int largest_remote_side = 16384;

/// What an application may ask for; version 0: whatever is compatible with everything.
struct RemoteContextWish {
  int version = 0;  ///< 100 * major + 10 * minor
  bool core = false;
};

struct RemoteContext {
  RemoteConfig config;
  RemoteContextWish wish;
  int current;     ///< threads that have it
  bool destroyed;  ///< and goes when no thread has it
};

struct RemoteThread {
  WindowSystem system = WindowSystem::glx;
  RemoteContext* context = nullptr;
  void* display = nullptr;
  std::uintptr_t draw = 0;
  std::uintptr_t read = 0;
};

RemoteThread& remote_thread();

/// Null when the GL server cannot make such a context.
RemoteContext* new_remote_context(const RemoteConfig& config, const RemoteContextWish& wish,
                                  const RemoteContext* share);
/// Says once what a viewer that asks for OpenGL ES should do.
void say_no_opengl_es();
void destroy_remote_context(RemoteContext* context);
void enter_remote_context(const RemoteThread& thread);
void leave_remote_context();

/// GLX 1.2 names configurations by their visual alone: the last one that was chosen by it is meant.
void note_choice(const RemoteConfig& config);
const RemoteConfig& chosen_for(const RemoteConfig& any_of_the_visual);

// Of GLX and EGL; `drawable` as the thread has it.
void* remote_glx_symbol(const char* name);
void remote_glx_drawable(void* display, std::uintptr_t drawable, RemoteDrawable* answer);
void* remote_egl_symbol(const char* name);
void remote_egl_drawable(void* display, std::uintptr_t surface, RemoteDrawable* answer);

}  // namespace understudy::interceptor
