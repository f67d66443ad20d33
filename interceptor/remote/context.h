// SPDX-License-Identifier: Apache-2.0
// Contexts of remote GLX and EGL: their requested format, and which thread has which context current. Their GL
// state is on the GL server.
#pragma once

#include <cstdint>

#include "interceptor/core.h"
#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

constexpr int largest_remote_side = 16384;

/// What an application may request; version 0: the highest compatible version.
struct RemoteContextWish {
  int version = 0;  ///< 100 * major + 10 * minor
  bool core = false;
};

struct RemoteContext {
  RemoteConfig config;
  RemoteContextWish wish;
  int current;     ///< number of threads that have it current
  bool destroyed;  ///< freed when no thread has it current
};

struct RemoteThread {
  WindowSystem system = WindowSystem::glx;
  RemoteContext* context = nullptr;
  void* display = nullptr;
  std::uintptr_t draw = 0;
  std::uintptr_t read = 0;
};

const RemoteThread& remote_thread();
/// What the thread has current in `system`: nothing if its context is the other window system's.
RemoteThread remote_thread(WindowSystem system);

/// Returns null if the GL server cannot create such a context.
RemoteContext* new_remote_context(const RemoteConfig& config, const RemoteContextWish& wish,
                                  const RemoteContext* share);
/// Logs once what to do about a viewer that requests OpenGL ES.
void say_no_opengl_es();
void destroy_remote_context(RemoteContext* context);
void enter_remote_context(const RemoteThread& thread);
/// Does nothing if the thread's context is the other window system's.
void leave_remote_context(WindowSystem system);

/// GLX 1.2 identifies configurations by their visual alone: the last one chosen for that visual is used.
void note_choice(const RemoteConfig& config);
const RemoteConfig& chosen_for(const RemoteConfig& any_of_the_visual);

// Implemented by GLX and EGL; `drawable` as recorded in RemoteThread.
void* remote_glx_symbol(const char* name);
void remote_glx_drawable(void* display, std::uintptr_t drawable, RemoteDrawable* answer);
void* remote_egl_symbol(const char* name);
void remote_egl_drawable(void* display, std::uintptr_t surface, RemoteDrawable* answer);

}  // namespace understudy::interceptor
