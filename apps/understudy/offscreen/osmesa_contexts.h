// SPDX-License-Identifier: Apache-2.0
// Contexts on OSMesa, Mesa's CPU renderer, which needs neither EGL nor a kernel graphics driver.
//
// OSMesa has no drawables: every context has its own framebuffer, and memory that it copies images to. Here,
// drawables are shared as on other window systems: the contents of a drawable move to the context that draws
// to it next, with depth and stencil, but without the accumulation buffer. Their single colour buffer is
// presented as a back buffer (spu/player/one_buffer.h), and always has alpha, because OSMesa draws incorrectly
// to pixels of three bytes.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "apps/understudy/offscreen/offscreen_contexts.h"
#include "spu/player/one_buffer.h"
#include "spu/window_system/shown_image.h"

namespace understudy::volume::offscreen {
class Osmesa;
}

namespace understudy::launcher {

class OsmesaContexts final : public OffscreenContexts {
 public:
  /// Opens libOSMesa. Throws std::runtime_error with what to install.
  OsmesaContexts();
  ~OsmesaContexts() override;
  OsmesaContexts(const OsmesaContexts&) = delete;
  OsmesaContexts& operator=(const OsmesaContexts&) = delete;

  void create(const spu::RecordedContext& context) override;
  void make_current(std::uint64_t context, std::uint64_t drawable, spu::Extent2D extent) override;
  void release_current() override;
  void destroy(std::uint64_t context) override;
  const spu::DispatchTable& driver() const override { return one_buffer_->table(); }

 private:
  struct Drawable {
    spu::Extent2D extent;
    std::vector<std::uint8_t> memory;             ///< memory that OSMesa copies images to
    std::uint64_t holder = 0;                     ///< context whose framebuffer holds the contents; 0: none
    std::optional<spu::WindowContents> contents;  ///< while there is no holder; empty: the drawable is new
  };
  struct Context {
    void* context = nullptr;
    bool core = false;
    bool double_buffered = false;
    bool depth_stencil = false;
    Drawable own;
    std::uint64_t drawable = 0;  ///< drawable whose contents its framebuffer may hold
  };

  void* make_context(const spu::RecordedContext& wanted, int version) const override;
  void end_context(void* context) const override;
  Drawable& drawable_of(Context& context, std::uint64_t number);
  void bind(Context& context, Drawable& drawable);
  /// Returns whether the current context is compiling a display list: calls that move contents would be
  /// recorded in it, so contents are not moved.
  bool compiles_a_list(const Context& context) const;
  /// Moves the contents out of the framebuffer that holds them.
  void take_out(Drawable& drawable);

  std::unique_ptr<volume::offscreen::Osmesa> osmesa_;
  std::unique_ptr<spu::OneBuffer> one_buffer_;
  /// Declared before the contexts, which may write to this memory until they end.
  std::map<std::uint64_t, Drawable> drawables_;
  std::map<std::uint64_t, Context> contexts_;
  std::uint64_t current_ = 0;  ///< number of a context; 0: none
};

}  // namespace understudy::launcher
