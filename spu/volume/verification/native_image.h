// SPDX-License-Identifier: Apache-2.0
// The application's native rendering: its run, repeated off screen into a float framebuffer.
//
// An 8-bit framebuffer loses fog (between 52 and 57 dB for usual slices, 39 dB at alpha 2/255), and would count
// the application's rounding against an exact image.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/context/float_framebuffer.h"
#include "spu/volume/observation/run.h"
#include "volume/depth_image.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Four floats per pixel of `rect`.
struct NativeImage {
  volume::Rect rect;
  std::vector<float> rgba;
};

/// Returns the part of `rect` that both the application and its nodes' image show: what of `viewport` lies left
/// of the application's framebuffer or below it is neither drawn nor shown.
inline volume::Rect comparable(const volume::Rect& rect, const volume::Rect& viewport) {
  return intersection(intersection(rect, viewport),
                      {0, 0, viewport.x + viewport.width, viewport.y + viewport.height});
}

/// What runs of one pipeline draw over transparent black (white for a minimum), one after the other; alpha is
/// blended like the colour.
class NativeDrawing {
 public:
  NativeDrawing(const GlContext& context, const Pipeline& pipeline, const volume::RenderRequest& request);

  /// False if the driver cannot provide the framebuffer.
  bool complete() const { return framebuffer_ && framebuffer_->complete(); }
  /// Draws the run's calls in the state for which they were made.
  void add(const Run& run);
  /// As add(), within `rect` only.
  void add_within(const Run& run, const volume::Rect& rect);
  /// Removes what was drawn in `rect`; `depth` is what opaque geometry left there.
  void clear(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth);
  /// Draws into one pixel, and clears it: drivers compile a program when it first draws into a kind of
  /// framebuffer, which is not part of the time of its drawing. `depth` as in clear().
  void compile(const Run& run, const volume::Rect& window, const std::optional<volume::DepthImage>& depth);
  /// As add(), and waits for the device to finish. Returns the time in milliseconds.
  double add_timed(const Run& run);
  NativeImage image(const volume::Rect& rect) const;

 private:
  void draw(const Run& run);

  const GlContext& context_;
  std::optional<FloatFramebuffer> framebuffer_;
  float background_ = 0;
};

/// Returns the native image of one run; null if `rect` is empty, or the driver cannot provide the framebuffer.
std::optional<NativeImage> native_image(const GlContext& context, const Run& run,
                                        const volume::RenderRequest& request, const volume::Rect& rect);

}  // namespace understudy::spu
