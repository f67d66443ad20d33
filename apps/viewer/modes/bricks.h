// SPDX-License-Identifier: Apache-2.0
// Like the table mode, but in many 3-D textures with edges of at most 64 texels, which share their
// outer texels with their neighbours: bricks are drawn one after another in visibility order, each
// with its part of all slices.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_bricks_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
