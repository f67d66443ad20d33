// SPDX-License-Identifier: Apache-2.0
// The transfer function of a scene as a colour map in ParaView's JSON format (colours of the field's values,
// and opacities), for ParaView's import of presets.
#pragma once

#include <optional>
#include <string>

#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::compositor {

/// Most control points; of longer transfer functions, so many values at equal distances are taken.
constexpr int max_colour_map_points = 1024;

/// Values are those of stored texels, as in the scene's file of texels. Opacities are those of one sample of
/// the application; of a pre-integration table, they and the colours are those of constant segments. Null for
/// volumes of colours, which have no transfer function.
std::optional<std::string> paraview_colour_map(const volume::Classification& classification,
                                               volume::TexelType type);

}  // namespace understudy::compositor
