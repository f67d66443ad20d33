// SPDX-License-Identifier: Apache-2.0
// Measures cost and error of settings, on a small image of the scene that is to be shown.
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
  double error = 0;  ///< greatest difference of a channel from the integral, over the rays that were checked
  double ms = 0;     ///< for an image of the request's size; a relative cost if the service loads for images
};

struct Calibration {
  std::vector<Measured> front;  ///< the cheapest setting of each error: cheapest first, most exact last
};

/// Measures the settings that the volume's ghost layer is wide enough for, all with `termination`. Finer ones
/// are not tried once images differ by less than `enough`; with 0, only time limits them. Takes well under a
/// second; on a slow or busy machine up to five, if `enough` requires it. Throws as the service does.
Calibration calibrate(compositor::ImageService& service, const Meaning& meaning,
                      const volume::VolumeDescription& volume, float termination, double enough);

/// Returns the pixels in which two images differ most, worst first, at most `count`. Images are empty outside.
std::vector<volume::Pixel> most_different(const volume::ImageView& a, const volume::ImageView& b,
                                          std::size_t count);

/// Returns pixels spread over a rectangle: `count` of an endless sequence, from its `first`-th on.
std::vector<volume::Pixel> spread_over(const volume::Rect& rect, std::size_t first, std::size_t count);

/// Integrates the first pixels, in order: as many as the nodes integrate in `usual_ms`, but no fewer than
/// `at_least`, which may take longer on a busy machine. A budget rests on few rays; lack of time must not make
/// them fewer.
std::vector<volume::PixelIntegral> integrals_of(compositor::ImageService& service,
                                                const volume::RenderRequest& request,
                                                std::span<const volume::Pixel> pixels, std::size_t at_least,
                                                double usual_ms);

/// Returns the greatest difference of a channel between an image and `integrals`, which belong to the first of
/// `pixels`. The image is empty outside.
double greatest_error(const volume::ImageView& image, std::span<const volume::Pixel> pixels,
                      std::span<const volume::PixelIntegral> integrals);

}  // namespace understudy::spu
