// SPDX-License-Identifier: Apache-2.0
// As the table mode, in many 3-D textures of at most 64 texels an edge that share their outer texels with their
// neighbours: the bricks are drawn one after the other in visibility order, each with its part of all slices.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_bricks_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
