// SPDX-License-Identifier: Apache-2.0
// The colours of a light from the eye, determined from what values of several colours show on slopes at many
// angles.
#pragma once

#include <vector>

#include "spu/volume/proxy/ray_normals.h"
#include "volume/light.h"

namespace understudy::spu {

/// Returns `light` with the colours that explain what is `seen` at each angle (value by value) of the `base`
/// colours: those of a highlight, and of diffuse light beside ambient light of another colour. White if values
/// do not determine them.
volume::Light with_colours(volume::Light light, const std::vector<Tint>& base,
                           const std::vector<std::vector<Tint>>& seen);

/// The response of a light of these colours at one angle.
struct ResponseFit {
  volume::LightResponse response;
  double worst = 0;  ///< the largest deviation of a channel from what the response makes of the base colours
};
ResponseFit response_fit(const volume::Light& light, const std::vector<Tint>& base,
                         const std::vector<Tint>& lit);

}  // namespace understudy::spu
