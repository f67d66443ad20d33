// A camera on a sphere around the volume, z up, that looks at its middle.
#pragma once

#include "volume/request.h"

namespace understudy::volume {

struct OrbitCamera {
  double azimuth = 30;    ///< degrees; 0 looks along +y, 90 along -x
  double elevation = 20;  ///< degrees above the plane of x and y
  double distance = 4;    ///< in half diagonals of the volume; below 1 the eye may be inside
};

/// A picture of `width` x `height` pixels of a volume of this size and spacing: one sample every `step` of the
/// smallest spacing along each ray, the first half a step behind where it enters. The classification is left to
/// the caller. Throws std::invalid_argument for a camera, a picture or a step that makes no sense.
RenderRequest orbit_request(const VolumeDescription& volume, const Vec3& spacing, const OrbitCamera& camera,
                            int width, int height, double step);

}  // namespace understudy::volume
