// SPDX-License-Identifier: Apache-2.0
// As the table mode, with the light of one direction on the surfaces that the field's gradient tells of (Levoy
// 1988): seven samples a fragment.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_lit_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
