// SPDX-License-Identifier: Apache-2.0
// Scalar RED texture and a 1-D colour table in GLSL 3.30 core; all slices in one glDrawArrays from a vertex
// buffer.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_core_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
