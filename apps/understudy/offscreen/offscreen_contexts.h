// SPDX-License-Identifier: Apache-2.0
// OpenGL contexts without a window system, for traces and for applications whose calls come from
// another process. They have the recorded versions and profiles, and each has its own drawable, or
// drawables that represent an application's windows. Uses EGL (egl_contexts.h), or OSMesa if EGL has no
// driver (osmesa_contexts.h).
#pragma once

#include <memory>
#include <string_view>

#include "spu/window_system/window_system.h"

namespace understudy::launcher {

class OffscreenContexts : public spu::WindowSystem {
 public:
  /// Returns the highest version of which contexts of the profile exist, as 100 * major + 10 * minor; 0: none.
  int highest_version(bool core) const;

 protected:
  /// Returns null if the driver has no such context. Uses `version` instead of the recorded one.
  virtual void* make_context(const spu::RecordedContext& wanted, int version) const = 0;
  virtual void end_context(void* context) const = 0;

  /// Makes a context of the recorded version, or of a lower one with a warning, because it may still have all
  /// that is used. Throws std::runtime_error if there is none.
  void* context_for(const spu::RecordedContext& wanted) const;
};

bool is_core(const spu::RecordedContext& context);

/// `library` is a value of --server-opengl (spu/options.h): egl, osmesa, or auto, which uses OSMesa with a
/// message if EGL creates no context. The libraries are opened here instead of at the program's start, so that
/// viewers can be launched without them. Throws std::runtime_error with what to install.
std::unique_ptr<OffscreenContexts> open_offscreen_contexts(std::string_view library);

}  // namespace understudy::launcher
