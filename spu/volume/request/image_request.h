// SPDX-License-Identifier: Apache-2.0
// What is asked of the nodes for one run, and what their image needs besides to become the run's.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/verification/schedule.h"
#include "volume/request.h"
#include "volume/rgba.h"

namespace understudy::spu {

struct ImageRequest {
  volume::RenderRequest request;
  VerificationSchedule::Inputs inputs;  ///< what the image depends on

  // Of a ray caster.
  bool ray_caster = false;
  volume::Rgba
      no_ray{};  ///< what fragments show, where they replace pixels, whose ray misses the box for rounding
  bool replaces_pixels = false;  ///< its fragments take the place of what is there
  /// The box covers, and is hidden in, each sample of a multisampled framebuffer's pixels by itself.
  bool covers_samples = false;
  bool eye_inside = false;  ///< its box has been cut before the eye
  /// No ray of its image has a visible sample: the program's own background, which it shows, proves nothing.
  bool background_alone = false;
  bool unproven = false;  ///< measured for this image, and perhaps right in this view alone
  /// What it draws into, where `request.window` is cut to where its program keeps fragments.
  std::optional<volume::Rect> uncut_window;
  /// Convex parts of the volume that cropping has left, nearest to the eye first; `request` asks for the first.
  std::vector<std::vector<volume::HalfSpace>> parts{{}};
  std::vector<volume::HalfSpace> ray_ends;  ///< planes where its rays begin and end
  /// Of the application's opaque geometry, where the request's own depth tells ends of rays as well.
  std::optional<volume::DepthImage> opaque;
};

}  // namespace understudy::spu
