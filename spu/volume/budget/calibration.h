// SPDX-License-Identifier: Apache-2.0
// What settings cost and how wrong they are, measured on a small image of the scene that is to be shown.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "spu/volume/budget/free_sampling.h"
#include "volume/pixel_integral.h"
#include "volume/rect.h"

namespace understudy::compositor {
class ImageService;
}
namespace understudy::volume {
struct ImageView;
struct RenderRequest;
struct VolumeDescription;
}  // namespace understudy::volume

namespace understudy::spu {

struct Measured {
  Setting setting;
  double error = 0;  ///< greatest difference of a channel from the integral, of the rays that were looked at
  double ms =
      0;  ///< for an image of the request's own size; a relative cost where the service loads for images
};

struct Calibration {
  std::vector<Measured> front;  ///< each the cheapest of its error: cheapest first, most exact last
};

/// Settings that the volume was sent with enough ghost layer for; `termination` belongs to all of them. Finer
/// ones are not tried once images differ by less than `enough`; with 0 there is never enough, but time. Takes
/// well under a second; on a slow or busy machine up to five, where they are what `enough` takes. Throws as the
/// service does.
Calibration calibrate(compositor::ImageService& service, const Meaning& meaning,
                      const volume::VolumeDescription& volume, float termination, double enough);

/// The pixels of two images of one rectangle that differ most, worst first; at most `count`.
std::vector<volume::Pixel> most_different(const volume::ImageView& a, const volume::ImageView& b,
                                          std::size_t count);

/// Pixels all over a rectangle, the `first`-th of an endless sequence and those after it.
std::vector<volume::Pixel> spread_over(const volume::Rect& rect, std::size_t first, std::size_t count);

/// Of the first pixels, in order: as many as the nodes integrate in `usual_ms`, but `at_least` so many, which
/// on a machine with other work may take longer. A budget is judged by few rays as it is: time must not make
/// them fewer.
std::vector<volume::PixelIntegral> integrals_of(compositor::ImageService& service,
                                                const volume::RenderRequest& request,
                                                std::span<const volume::Pixel> pixels, std::size_t at_least,
                                                double usual_ms);

/// The greatest difference of a channel between an image and the first integrals of `pixels`. Pixels beside
/// the image show nothing.
double greatest_error(const volume::ImageView& image, std::span<const volume::Pixel> pixels,
                      std::span<const volume::PixelIntegral> integrals);

}  // namespace understudy::spu
