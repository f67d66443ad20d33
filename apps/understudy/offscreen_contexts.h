// OpenGL contexts on EGL without a window system, for traces: the recorded versions, profiles and pixel
// formats, each context with a pbuffer of its own.
#pragma once

#include <map>
#include <memory>

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
  void make_current(std::uint64_t context, spu::Extent2D drawable) override;
  void release_current() override;
  void destroy(std::uint64_t context) override;
  const spu::DispatchTable& driver() const override { return driver_; }

 private:
  struct Egl;
  struct Context;

  void clear(const Context& context);

  std::unique_ptr<Egl> egl_;
  std::map<std::uint64_t, Context> contexts_;
  spu::DispatchTable driver_{};
};

}  // namespace understudy::launcher
