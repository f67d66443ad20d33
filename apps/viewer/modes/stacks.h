// SPDX-License-Identifier: Apache-2.0
// Three stacks of 2-D textures, one per axis, with colours per voxel: the stack that faces the eye is
// drawn, one quad per slice (Cabral, Cam and Foran 1994, for hardware without 3-D textures). Fixed
// function, immediate mode.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_stacks_mode(Texels texels, const std::string& file);

}  // namespace viewer
