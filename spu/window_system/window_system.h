// SPDX-License-Identifier: Apache-2.0
// The interface that provides windows and contexts to the player of a stream, in place of the recorded
// application's window system.
#pragma once

#include <cstdint>

#include "dispatch/table.h"

namespace understudy::spu {

struct Extent2D {
  int width = 0;
  int height = 0;
  bool operator==(const Extent2D&) const = default;
};

/// The words of a `context` event (stream/event.h).
struct RecordedContext {
  std::uint64_t number = 0;
  std::uint64_t shares_with = 0;  ///< number of an earlier context; 0: none
  int version = 0;                ///< 100 * major + 10 * minor
  std::uint32_t profile = 0;      ///< GL_CONTEXT_PROFILE_MASK; 0 before OpenGL 3.2
  int red = 8, green = 8, blue = 8, alpha = 8;
  int depth = 24;
  int stencil = 8;
  int samples = 0;
  bool double_buffered = true;
};

class WindowSystem {
 public:
  virtual ~WindowSystem() = default;
  /// Throws std::runtime_error if neither such a context nor a suitable replacement can be created.
  virtual void create(const RecordedContext& context) = 0;
  /// Makes the context current with the drawable of this number (0: the context's own) and size. A drawable
  /// whose size changes loses its contents, as windows may. Throws std::runtime_error.
  virtual void make_current(std::uint64_t context, std::uint64_t drawable, Extent2D extent) = 0;
  virtual void release_current() = 0;
  /// Destroys a context, which must not be current.
  virtual void destroy(std::uint64_t context) = 0;
  /// The driver's functions, for all contexts.
  virtual const DispatchTable& driver() const = 0;
};

}  // namespace understudy::spu
