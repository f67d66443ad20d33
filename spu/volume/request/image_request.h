// SPDX-License-Identifier: Apache-2.0
// The request to the nodes for one run, and what is needed besides to make their image that of the run.
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

  // For ray casters:
  bool ray_caster = false;
  volume::Rgba
      no_ray{};  ///< colour of fragments that replace pixels, but whose ray misses the box due to rounding
  bool replaces_pixels = false;  ///< its fragments replace pixels
  /// The box covers, and is hidden in, each sample of a multisampled framebuffer's pixels separately.
  bool covers_samples = false;
  bool eye_inside = false;  ///< its box was clipped in front of the eye
  /// No ray of its image has a visible sample: the program's own background in it proves nothing.
  bool background_alone = false;
  bool unproven = false;  ///< measured for this image, and perhaps valid in this view only
  /// What it is drawn into, if `request.window` is cut to where its program keeps fragments.
  std::optional<volume::Rect> uncut_window;
  /// Convex parts of the volume that cropping has left, nearest to the eye first; `request` is for the first.
  std::vector<std::vector<volume::HalfSpace>> parts{{}};
  std::vector<volume::HalfSpace> ray_ends;  ///< planes where its rays begin and end
  /// Depth of the application's opaque geometry, if the request's own depth also marks the ends of rays.
  std::optional<volume::DepthImage> opaque;
};

}  // namespace understudy::spu
