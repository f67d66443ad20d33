// SPDX-License-Identifier: Apache-2.0
// Makes the frame that a viewer's --describe output describes, to be drawn without OpenGL from the description
// and the volume file alone.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "tests/emulation/slices.h"

namespace emulation {

/// Without the wireframe box and the axes, which are not described.
Frame viewer_frame(const nlohmann::json& description);

/// The frame's image in exact arithmetic: RGB, channel values 0 to 255 before rounding, top row first.
std::vector<double> emulate(const nlohmann::json& description);

}  // namespace emulation
