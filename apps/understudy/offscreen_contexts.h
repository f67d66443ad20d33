// OpenGL contexts on EGL without a window system, for traces: the recorded versions, profiles and pixel
// formats, each context with a pbuffer of its own, or with those that stand for an application's windows.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "spu/player/window_system.h"

namespace understudy::launcher {

class OffscreenContexts final : public spu::WindowSystem {
 public:
  /// Opens libEGL here and not at the program's start, so that viewers are launched without it. Throws
  /// std::runtime_error with what to install.
  OffscreenContexts();
  ~OffscreenContexts() override;
  OffscreenContexts(const OffscreenContexts&) = delete;
  OffscreenContexts& operator=(const OffscreenContexts&) = delete;

  void create(const spu::RecordedContext& context) override;
  void make_current(std::uint64_t context, std::uint64_t drawable, spu::Extent2D extent) override;
  void release_current() override;
  void destroy(std::uint64_t context) override;
  const spu::DispatchTable& driver() const override { return driver_; }
  /// The highest version, as 100 * major + 10 * minor, of which there are contexts of the profile; 0: none.
  int highest_version(bool core) const;

 private:
  struct Egl;
  struct Context;
  struct Surface;

  void clear(void* config, void* surface);

  std::unique_ptr<Egl> egl_;
  std::map<std::uint64_t, Context> contexts_;
  /// By configuration and number of the drawable: contexts of several configurations may draw into a window.
  std::map<std::pair<void*, std::uint64_t>, Surface> surfaces_;
  spu::DispatchTable driver_{};
};

}  // namespace understudy::launcher
