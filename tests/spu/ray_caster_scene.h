// SPDX-License-Identifier: Apache-2.0
// An application that casts rays, drawn with and without the chain of units.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "box_ray_caster.h"

namespace understudy::spu::testing {

struct RayCasterScene {
  explicit RayCasterScene(const MarchStyle& style);

  /// The image with the chain (`under`) or without it.
  std::vector<float> frame(bool under, double angle, float wall = 0);
  /// Expects it to be substituted with a PSNR of at least `least` dB against the application's image; returns
  /// the image.
  std::vector<float> expect_alike(double angle, const std::string& what, double least);

  std::unique_ptr<GlApplication> app;  ///< null: no core profile context is available
  BoxRayCaster caster;
};

}  // namespace understudy::spu::testing
