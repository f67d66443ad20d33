// Trust, and check: the application's own run is drawn off screen and compared with the image that would
// replace it.
//
// The framebuffer is float. An 8-bit one loses fog (between 52 and 57 dB for usual slices, 39 dB at alpha
// 2/255), and would judge the exact image by the application's rounding.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "spu/volume/context.h"
#include "spu/volume/float_framebuffer.h"
#include "spu/volume/run.h"
#include "volume/request.h"

namespace understudy::spu {

struct Difference {
  double max = 0;
  double mean_square = 0;  ///< over the pixels of the footprint, all four channels
  double psnr() const;     ///< dB; infinite when equal
};

/// Four floats a pixel of `rect`.
struct ApplicationImage {
  volume::Rect rect;
  std::vector<float> rgba;
};

/// What runs of one pipeline draw over transparent black (white for a minimum), one after the other: alpha
/// going the way of the colour.
class ApplicationDrawing {
 public:
  ApplicationDrawing(const GlContext& context, const Pipeline& pipeline, const volume::RenderRequest& request);

  /// False where the driver cannot provide the framebuffer.
  bool complete() const { return framebuffer_ && framebuffer_->complete(); }
  /// Draws the run's calls in the state that they were made for.
  void add(const Run& run);
  ApplicationImage image(const volume::Rect& rect) const;

 private:
  const GlContext& context_;
  std::optional<FloatFramebuffer> framebuffer_;
};

/// That of one run. Null when the driver cannot provide the framebuffer.
std::optional<ApplicationImage> application_image(const GlContext& context, const Run& run,
                                                  const volume::RenderRequest& request,
                                                  const volume::Rect& rect);

/// Between that and `image`, which is empty outside of its rectangle, both as the application's framebuffer
/// could show them: clamped to [0,1], or, where it is float, as parts of the largest value.
Difference difference_between(const Pipeline& pipeline, const ApplicationImage& drawn,
                              const volume::ImageView& image);

/// Both of these. Null when the driver cannot provide the framebuffer.
std::optional<Difference> compare_with_application(const GlContext& context, const Run& run,
                                                   const volume::RenderRequest& request,
                                                   const volume::ImageView& image);

}  // namespace understudy::spu
