// SPDX-License-Identifier: Apache-2.0
// Like the table mode, but every frame shows another time step, uploaded into the same texture: the volume, or
// a box in its middle, becomes brighter and darker in turn. 8 bits.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_time_mode(const Texels& texels, const std::string& file, TimeStep step);

}  // namespace viewer
