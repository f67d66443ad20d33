// SPDX-License-Identifier: Apache-2.0
// The camera of a viewer as its hand moves it: rotated by an arcball, moved across the image, brought nearer.
#pragma once

#include <array>

#include "volume/orbit_camera.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::launcher {

/// In halves of the image's shorter side, right and up from its middle.
using ImagePoint = std::array<double, 2>;

struct ViewCamera {
  volume::OrbitCamera orbit;
  ImagePoint shift{};  ///< where the volume's middle is seen

  bool operator==(const ViewCamera&) const = default;
};

constexpr double nearest_distance = 0.02;  ///< in half diagonals, as OrbitCamera has it
constexpr double farthest_distance = 50;
constexpr double farthest_shift = 100;

/// Shoemake's ball of radius 1 around the volume's middle: the point under `from` comes under `to`, turned by
/// twice the angle between them, so that any way of several moves ends where one move would. (Shoemake 1992,
/// ARCBALL, Graphics Interface.)
ViewCamera rotated(const ViewCamera& camera, const ImagePoint& from, const ImagePoint& to);
/// What is seen moves by so much.
ViewCamera panned(const ViewCamera& camera, const ImagePoint& by);
/// The camera comes nearer by the factor (below 1: goes away); what is seen at `at` stays there.
ViewCamera zoomed(const ViewCamera& camera, double factor, const ImagePoint& at);

/// Brings the request of `camera.orbit` where the shift is.
void shift(volume::RenderRequest& request, const ImagePoint& shift);

}  // namespace understudy::launcher
