// SPDX-License-Identifier: Apache-2.0
// A camera on a sphere around the volume that looks at its middle, z up unless it rolls.
#pragma once

#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;
struct VolumeDescription;

/// Where the eye is, seen from the volume's middle.
struct OrbitCamera {
  double azimuth = 30;    ///< degrees; 0 looks along +y, 90 along -x
  double elevation = 20;  ///< degrees above the plane of x and y
  double distance = 4;    ///< in half diagonals of the volume; below 1 the eye may be inside
  double roll = 0;        ///< degrees that the camera turns about its line of sight; 180: z is down

  bool operator==(const OrbitCamera&) const = default;
};

/// Degrees, of the shorter side.
constexpr double orbit_field_of_view = 30;

/// From the volume's middle to the eye, of length 1, in the volume's axes.
Vec3 eye_direction(const OrbitCamera& camera);

/// An image of `width` x `height` pixels of a volume of this size and spacing: one sample every `step` of the
/// smallest spacing along each ray, the first half a step behind where it enters. The classification is left to
/// the caller. Throws std::invalid_argument for a camera, an image or a step that makes no sense.
RenderRequest orbit_request(const VolumeDescription& volume, const Vec3& spacing, const OrbitCamera& camera,
                            int width, int height, double step);

}  // namespace understudy::volume
