// SPDX-License-Identifier: Apache-2.0
// Contexts on OSMesa, Mesa's renderer on the CPU that needs neither EGL nor a kernel's graphics driver.
//
// OSMesa knows no drawables: every context has a framebuffer of its own, and memory that it copies images to.
// Here drawables are shared as on other window systems: what one shows moves to the context that draws into it
// next, with depth and stencil, but not what accumulates. Their one colour buffer looks like a back buffer
// (spu/player/one_buffer.h), and always has alpha: OSMesa draws wrongly into pixels of three bytes.
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
    std::vector<std::uint8_t> memory;             ///< that OSMesa copies images to
    std::uint64_t holder = 0;                     ///< context whose framebuffer has the contents; 0: none
    std::optional<spu::WindowContents> contents;  ///< while there is no holder; none: it is new
  };
  struct Context {
    void* context = nullptr;
    bool core = false;
    bool double_buffered = false;
    bool depth_stencil = false;
    Drawable own;
    std::uint64_t drawable = 0;  ///< whose contents its framebuffer may have
  };

  void* make_context(const spu::RecordedContext& wanted, int version) const override;
  void end_context(void* context) const override;
  Drawable& drawable_of(Context& context, std::uint64_t number);
  void bind(Context& context, Drawable& drawable);
  /// Whether the current one does: whatever moves contents would be recorded there, so they are left.
  bool compiles_a_list(const Context& context) const;
  /// Takes the contents out of the framebuffer that has them.
  void take_out(Drawable& drawable);

  std::unique_ptr<volume::offscreen::Osmesa> osmesa_;
  std::unique_ptr<spu::OneBuffer> one_buffer_;
  /// Before the contexts, which may write there until they end.
  std::map<std::uint64_t, Drawable> drawables_;
  std::map<std::uint64_t, Context> contexts_;
  std::uint64_t current_ = 0;  ///< number of a context; 0: none
};

}  // namespace understudy::launcher
