// SPDX-License-Identifier: Apache-2.0
// Contexts on EGL without a window system, each with its own pbuffer, or with pbuffers that represent
// an application's windows.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "apps/understudy/offscreen/offscreen_contexts.h"

namespace understudy::launcher {

class EglContexts final : public OffscreenContexts {
 public:
  /// Opens libEGL. Throws std::runtime_error with what to install.
  EglContexts();
  ~EglContexts() override;
  EglContexts(const EglContexts&) = delete;
  EglContexts& operator=(const EglContexts&) = delete;

  void create(const spu::RecordedContext& context) override;
  void make_current(std::uint64_t context, std::uint64_t drawable, spu::Extent2D extent) override;
  void release_current() override;
  void destroy(std::uint64_t context) override;
  const spu::DispatchTable& driver() const override { return driver_; }

 private:
  struct Library;
  struct Context;
  struct Surface;

  void* make_context(const spu::RecordedContext& wanted, int version) const override;
  void end_context(void* context) const override;
  void clear(void* config, void* surface);

  std::unique_ptr<Library> egl_;
  std::map<std::uint64_t, Context> contexts_;
  /// By configuration and number of the drawable: contexts of several configurations may draw to one window.
  std::map<std::pair<void*, std::uint64_t>, Surface> surfaces_;
  spu::DispatchTable driver_{};
};

}  // namespace understudy::launcher
