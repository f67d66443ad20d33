// SPDX-License-Identifier: Apache-2.0
// Like the table mode, with directional light on the surfaces that the field's gradient indicates (Levoy 1988):
// seven samples per fragment.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_lit_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
