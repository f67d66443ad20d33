// SPDX-License-Identifier: Apache-2.0
// The frame that a viewer's --describe tells of, to be drawn without OpenGL: nothing is known but the
// description and the volume file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "tests/emulation/slices.h"

namespace emulation {

/// Without the box's frame and the axes: they are not described.
Frame viewer_frame(const nlohmann::json& description);

/// Its image in exact arithmetic: RGB, channel values 0 to 255 before rounding, top row first.
std::vector<double> emulate(const nlohmann::json& description);

}  // namespace emulation
