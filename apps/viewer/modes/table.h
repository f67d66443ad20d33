// SPDX-License-Identifier: Apache-2.0
// Scalar LUMINANCE texture and a 1-D colour table in GLSL 1.20; one triangle fan per slice from client vertex
// arrays.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_table_mode(const Texels& texels, const std::string& file);

}  // namespace viewer
