// SPDX-License-Identifier: Apache-2.0
// A camera that turns around the volume.
//
// Object space: the volume's box is centred at the origin, its diagonal is 1 long, z is up.
// Azimuth 0 looks along +y; it moves the eye anticlockwise seen from above. Elevation raises the eye.
#pragma once

#include "apps/viewer/model/vector_math.h"

namespace viewer {

inline constexpr double min_distance = 0.05;
inline constexpr double max_distance = 100.0;

struct Camera {
  double azimuth = 30;    ///< degrees
  double elevation = 25;  ///< degrees, -90 to 90
  double distance = 2;    ///< from the eye to the origin, in box diagonals; 2 shows the whole box from any side
  bool orthographic = false;
  double field_of_view = 30;  ///< degrees, over the window's shorter side
};

struct Matrices {
  Mat4 modelview;
  Mat4 projection;
};

/// `width` and `height` are those of the window, in pixels. The orthographic image has the size of the
/// perspective one at the origin.
Matrices matrices_of(const Camera& camera, int width, int height);

/// The direction of view in object space, of length 1.
Vec3 view_direction(const Camera& camera);

/// Mouse drag: `right` and `down` in pixels.
void rotate(Camera& camera, double right, double down);

/// Moves the eye nearer by `steps` wheel clicks (negative: away).
void zoom(Camera& camera, double steps);

}  // namespace viewer
