// SPDX-License-Identifier: Apache-2.0
// Pre-integrated segments (Engel, Kraus and Ertl 2001): each fragment looks at the slice's front and back
// coordinate, and in a 2-D table at what lies between the two values.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_preintegrated_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
