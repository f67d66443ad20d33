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

  /// What it shows, under the chain or not.
  std::vector<float> frame(bool under, double angle, float wall = 0);
  /// Expects it to be substituted, and at least so much like the application's own, in dB; that image.
  std::vector<float> expect_alike(double angle, const std::string& what, double least);

  std::unique_ptr<GlApplication> app;  ///< null: there is no context of a core profile here
  BoxRayCaster caster;
};

}  // namespace understudy::spu::testing
