// SPDX-License-Identifier: Apache-2.0
// An OpenGL 3.3 core context without a window, on EGL or on OSMesa (volume/offscreen/).
#pragma once

#include <memory>

#include "volume/offscreen/system_library.h"

namespace understudy::volume::glsl {

using offscreen::ContextUnavailable;

class OffscreenContext {
 public:
  using Function = void (*)();

  virtual ~OffscreenContext() = default;

  /// On the calling thread; throws std::runtime_error.
  virtual void make_current() = 0;
  /// EGL and OSMesa of the same Mesa share the current context without informing each other: neither may be
  /// left current.
  virtual void release() noexcept = 0;
  /// Null if there is no such function.
  virtual Function address(const char* name) const = 0;
};

/// Tries EGL devices first, which include graphics cards, then Mesa's surfaceless platform. Throws
/// ContextUnavailable.
std::unique_ptr<OffscreenContext> egl_context();

/// Throws ContextUnavailable.
std::unique_ptr<OffscreenContext> osmesa_context();

}  // namespace understudy::volume::glsl
