// SPDX-License-Identifier: Apache-2.0
// OpenGL contexts without a window system, for traces and for applications whose calls come from elsewhere: of
// the recorded versions and profiles, each with a drawable of its own, or with those that stand for an
// application's windows. On EGL (egl_contexts.h), or where that has no driver, on OSMesa (osmesa_contexts.h).
#pragma once

#include <memory>
#include <string_view>

#include "spu/window_system/window_system.h"

namespace understudy::launcher {

class OffscreenContexts : public spu::WindowSystem {
 public:
  /// The highest version, as 100 * major + 10 * minor, of which there are contexts of the profile; 0: none.
  int highest_version(bool core) const;

 protected:
  /// Null where the driver has no such context. The version is the one that is asked for, not the recorded one.
  virtual void* make_context(const spu::RecordedContext& wanted, int version) const = 0;
  virtual void end_context(void* context) const = 0;

  /// A context of the recorded version, or of a lower one, which is said: it may still have all that is used.
  /// Throws std::runtime_error when there is none.
  void* context_for(const spu::RecordedContext& wanted) const;
};

bool is_core(const spu::RecordedContext& context);

/// `library` as --server-opengl has it (spu/options.h): egl, osmesa, or auto, which is OSMesa where EGL makes
/// no context, and says so. The libraries are opened here and not at the program's start, so that viewers are
/// launched without them. Throws std::runtime_error with what to install.
std::unique_ptr<OffscreenContexts> open_offscreen_contexts(std::string_view library);

}  // namespace understudy::launcher
