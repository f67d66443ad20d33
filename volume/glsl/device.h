// SPDX-License-Identifier: Apache-2.0
// One OpenGL context with its entry points and its programs. All ray casters of a process can share it; it
// serves one thread at a time.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "volume/glsl/functions.h"
#include "volume/glsl/march_shader.h"
#include "volume/glsl/offscreen_context.h"
#include "volume/glsl/texture_memory.h"

namespace understudy::volume::glsl {

/// The GL backend cannot draw this request or this volume, for the reason in the message; the CPU can.
class NotSupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Other volumes use all the memory that textures may take; some may become free later.
class NoTextureMemory : public NotSupported {
 public:
  using NotSupported::NotSupported;
};

/// OpenGL has no memory for this texture, but may have enough for a smaller one.
class OutOfMemory : public NotSupported {
 public:
  using NotSupported::NotSupported;
};

enum class Platform { egl, osmesa };

class Device {
 public:
  /// Throws ContextUnavailable.
  explicit Device(Platform platform, const TextureMemoryWish& memory = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Renderer, version and platform: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) Mesa 22.3.6,
  /// on EGL".
  const std::string& description() const { return description_; }
  int max_texture_edge() const { return max_texture_edge_; }
  int max_volume_edge() const { return max_volume_edge_; }
  TextureMemory& texture_memory() { return *texture_memory_; }
  const TextureMemory& texture_memory() const { return *texture_memory_; }

  /// Keeps the context current on the calling thread; do not nest.
  class Current {
   public:
    explicit Current(Device& device) : context_(*device.context_) { context_.make_current(); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
    ~Current() { context_.release(); }

   private:
    OffscreenContext& context_;
  };

  // All of the following require the context to be current.

  const Functions& gl() const { return gl_; }
  /// Links the program, or returns it from the cache. Throws std::runtime_error with the compiler's message.
  const MarchProgram& program(const MarchVariant& variant);
  /// Throws when OpenGL has reported an error: OutOfMemory or else NotSupported, with `what` in the message.
  void check(const char* what) const;

 private:
  std::unique_ptr<OffscreenContext> context_;
  Functions gl_;
  std::string description_;
  int max_texture_edge_ = 0;
  int max_volume_edge_ = 0;
  std::optional<TextureMemory> texture_memory_;
  std::map<MarchVariant, MarchProgram> programs_;
};

}  // namespace understudy::volume::glsl
