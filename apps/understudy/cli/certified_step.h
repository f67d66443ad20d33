// SPDX-License-Identifier: Apache-2.0
// Chooses the step of an image by its certified error bound.
#pragma once

#include <functional>

#include "apps/understudy/cli/render_report.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "compositor/service.h"

namespace understudy::launcher {

/// The finest step that is tried, in voxels.
constexpr double finest_certified_step = 1.0 / 128;

struct CertifiedStep {
  double step = 0;                ///< in voxels
  volume::RenderRequest request;  ///< for the image
  BoundFigures bound;             ///< `time_ms`: of the bounds at all steps that were tried
};

/// Computes the figures of an image whose pixels are error bounds.
BoundFigures bound_figures(const volume::ImageView& image);

/// Returns a step at which no channel of any pixel is farther than `error` from the integral. Begins with the
/// step of `scene`, and predicts the next one from the bound, which falls with the square of the step at most.
/// `tried` is called with each step and its greatest bound. Throws std::runtime_error, with the bound, if
/// `error` cannot be certified with the finest step either.
CertifiedStep certified_step(compositor::ImageService& service, const FileScene& scene,
                             const volume::TexelFigures& values, double error,
                             const std::function<void(double step, double bound)>& tried);

}  // namespace understudy::launcher
