// SPDX-License-Identifier: Apache-2.0
// Slices in immediate mode whose fragments come from a program in assembly language.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "tests/adversary/scenario.h"

namespace adversary {

using Parameter = std::array<float, 4>;

/// What a scenario changes: parameters of the fragment program, frame by frame.
struct AssemblySlices {
  std::string instructions;  ///< between header and END; the volume is texture[0], a 1-D table texture[1]
  std::function<Parameter(int frame)> local;        ///< program.local[0]
  std::function<Parameter(int frame)> environment;  ///< program.env[0]
};

/// Returns what Scenario::start is to be: 64 slices from back to front, blended over.
std::function<DrawFrame(Canvas&)> assembly_slices(AssemblySlices slices);

}  // namespace adversary
