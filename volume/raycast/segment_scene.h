// SPDX-License-Identifier: Apache-2.0
// Surfaces, light and pre-integration prepared for a kernel: in units of the texel type, and of cells.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "volume/description.h"
#include "volume/light.h"
#include "volume/surface.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// Whether intervals between samples are integrated: for surfaces, pre-integration or adaptive steps.
bool has_segments(const RenderRequest& request);

/// Whether the request has surfaces, light, pre-integration or adaptive steps.
bool walks_segments(const RenderRequest& request);

/// The ghost layer that segments and gradients need, in cells: how far beyond its own cells a rank samples. The
/// volume's ghost layer must be no smaller. For steps between planes it depends on the camera; otherwise their
/// metric must not be singular.
int ghost_layer_needed(const VolumeDescription& volume, const RenderRequest& request);

/// Upper bound of the length of a step along each axis, in cells.
std::array<double, 3> step_reach(const VolumeDescription& volume, const RenderRequest& request);

/// Throws std::invalid_argument when surfaces, light or method are invalid for `volume`.
void validate_segments(const VolumeDescription& volume, const RenderRequest& request);

/// A surface; its colour is premultiplied.
struct Level {
  float value = 0;
  Rgba colour{};
};

/// A light in terms of gradients g per cell. With |g| = sqrt(g . metric g), the cosine between normal and light
/// is -g . light / |g|, and the cosine between normal and h is -g . half / |g|.
struct PreparedLight {
  PreparedLight(const Light& light, const VolumeDescription& volume);

  /// `half` of a ray with direction `step` (in cells); zero if undefined.
  std::array<float, 3> half(const std::array<float, 3>& step) const;
  /// `light` of the same ray.
  std::array<float, 3> light(const std::array<float, 3>& step) const;
  /// The model's response at a cosine; it must not be empty.
  LightResponse response_at(float cosine) const;

  Light model;
  std::array<float, 9> metric{};
  float full_slope = 0;                 ///< the model's, in units of the texel type
  NormalGuard guard{};                  ///< likewise
  GradientOpacity gradient_opacity{};   ///< likewise
  std::array<float, 3> reach{1, 1, 1};  ///< the model's

 private:
  Vec3 to_eye(const std::array<float, 3>& step) const;
  std::array<float, 3> over_gradients(const Vec3& direction) const;

  Vec3 direction_{};  ///< unit vector, or zero
  std::array<double, 9> inverse_{};
  Vec3 size_{};
};

struct SegmentScene {
  SegmentScene(const VolumeDescription& volume, const RenderRequest& request);

  std::vector<Level> levels;  ///< ascending
  bool pre_integrated = false;
  bool lit_samples = false;
  std::optional<PreparedLight> prepared_light;
};

}  // namespace understudy::volume
