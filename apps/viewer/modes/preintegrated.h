// SPDX-License-Identifier: Apache-2.0
// Pre-integrated segments (Engel, Kraus and Ertl 2001): each fragment samples the front and the back of the
// slice segment, and looks up the segment's colour by these two values in a 2-D table.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_preintegrated_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
