// SPDX-License-Identifier: Apache-2.0
// A camera on a sphere around the volume, looking at its centre; z points up unless the camera rolls.
#pragma once

#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;
struct VolumeDescription;

/// Position of the eye relative to the volume's centre.
struct OrbitCamera {
  double azimuth = 30;    ///< degrees; 0 looks along +y, 90 along -x
  double elevation = 20;  ///< degrees above the xy plane
  double distance = 4;    ///< in half diagonals of the volume; below 1 the eye may be inside
  double roll = 0;        ///< degrees of rotation about the view direction; 180: z points down

  bool operator==(const OrbitCamera&) const = default;
};

/// Field of view of the shorter side, in degrees.
constexpr double orbit_field_of_view = 30;

/// Unit vector from the volume's centre to the eye, in the volume's axes.
Vec3 eye_direction(const OrbitCamera& camera);

/// A request for an image of `width` x `height` pixels of a volume of this size and spacing, with one sample
/// every `step` times the smallest spacing along each ray, the first half a step after its entry. The
/// classification is left to the caller. Throws std::invalid_argument for an invalid camera, image size or
/// step.
RenderRequest orbit_request(const VolumeDescription& volume, const Vec3& spacing, const OrbitCamera& camera,
                            int width, int height, double step);

}  // namespace understudy::volume
