// SPDX-License-Identifier: Apache-2.0
// The camera of a view as the user moves it: rotated by an arcball, panned and zoomed.
#pragma once

#include <array>

#include "volume/orbit_camera.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::launcher {

/// A point in the image, in halves of its shorter side, right and up from its centre.
using ImagePoint = std::array<double, 2>;

struct ViewCamera {
  volume::OrbitCamera orbit;
  ImagePoint shift{};  ///< image position of the volume's centre

  bool operator==(const ViewCamera&) const = default;
};

constexpr double nearest_distance = 0.02;  ///< in half diagonals, as in OrbitCamera
constexpr double farthest_distance = 50;
constexpr double farthest_shift = 100;

/// Rotates by Shoemake's ball of radius 1 around the volume's centre: the point at `from` moves to `to`. The
/// rotation is by twice the angle between them, so that a sequence of moves ends where a single move would.
/// (Shoemake 1992, ARCBALL, Graphics Interface.)
ViewCamera rotated(const ViewCamera& camera, const ImagePoint& from, const ImagePoint& to);
/// Moves the visible content by this displacement.
ViewCamera panned(const ViewCamera& camera, const ImagePoint& by);
/// Moves the camera nearer by the factor (below 1: farther); what is visible at `at` stays there.
ViewCamera zoomed(const ViewCamera& camera, double factor, const ImagePoint& at);

/// Applies the shift to a request that was made from `camera.orbit`.
void shift(volume::RenderRequest& request, const ImagePoint& shift);

}  // namespace understudy::launcher
