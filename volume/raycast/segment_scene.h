// SPDX-License-Identifier: Apache-2.0
// Surfaces, light and pre-integration made ready for a kernel: in units of the texel type, and of cells.
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

/// Whether what lies between a request's samples counts: it has surfaces, segments or adaptive steps.
bool has_segments(const RenderRequest& request);

/// Whether a request has surfaces, light, segments or adaptive steps; other requests know nothing of all this.
bool walks_segments(const RenderRequest& request);

/// How far from its own cells a rank looks for the sake of segments and gradients, in cells: the volume's
/// ghost layer must be no smaller. Of steps between planes it depends on the camera; elsewhere
/// their metric must not be singular.
int ghost_layer_needed(const VolumeDescription& volume, const RenderRequest& request);

/// How far one step leads along each axis, at most, in cells.
std::array<double, 3> step_reach(const VolumeDescription& volume, const RenderRequest& request);

/// Throws std::invalid_argument when surfaces, light or method make no sense on `volume`.
void validate_segments(const VolumeDescription& volume, const RenderRequest& request);

/// A surface; its colour is premultiplied.
struct Level {
  float value = 0;
  Rgba colour{};
};

/// A light over gradients g per cell. With |g| = sqrt(g . metric g), the cosine between normal and light is
/// -g . light / |g|, and that between normal and h is -g . half / |g|.
struct PreparedLight {
  PreparedLight(const Light& light, const VolumeDescription& volume);

  /// `half` of a ray that goes along `step` (in cells); zero where there is none.
  std::array<float, 3> half(const std::array<float, 3>& step) const;
  /// `light` of the same ray.
  std::array<float, 3> light(const std::array<float, 3>& step) const;
  /// The model's response, which is not empty, at a cosine.
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

  Vec3 direction_{};  ///< of length 1, or zero
  std::array<double, 9> inverse_{};
  Vec3 size_{};
};

struct SegmentScene {
  SegmentScene(const VolumeDescription& volume, const RenderRequest& request);

  std::vector<Level> levels;  ///< rising
  bool pre_integrated = false;
  bool lit_samples = false;
  std::optional<PreparedLight> prepared_light;
};

}  // namespace understudy::volume
