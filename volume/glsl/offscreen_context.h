// SPDX-License-Identifier: Apache-2.0
// An OpenGL 3.3 core context without window, on EGL or on OSMesa. Both libraries are opened when one is asked
// for, never linked: a process without them runs, and OSMesa exports OpenGL's own names.
#pragma once

#include <memory>
#include <stdexcept>

namespace understudy::volume::glsl {

/// There is no such context on this machine; the message says why, and what to install.
class ContextUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class OffscreenContext {
 public:
  using Function = void (*)();

  virtual ~OffscreenContext() = default;

  /// On the calling thread; throws std::runtime_error.
  virtual void make_current() = 0;
  /// EGL and OSMesa of one Mesa share their notion of the current context without telling each other: neither
  /// may be left current.
  virtual void release() noexcept = 0;
  /// Null where there is none.
  virtual Function address(const char* name) const = 0;
};

/// Devices first, which reach a graphics card where there is one, then Mesa's surfaceless platform. Throws
/// ContextUnavailable.
std::unique_ptr<OffscreenContext> egl_context();

/// Throws ContextUnavailable.
std::unique_ptr<OffscreenContext> osmesa_context();

}  // namespace understudy::volume::glsl
