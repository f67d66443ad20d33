// SPDX-License-Identifier: Apache-2.0
// Checks whether a viewer's volume is substituted on this machine, for each available way to run: runs the
// bundled viewer off screen on a small volume.
#pragma once

#include <functional>
#include <vector>

#include "apps/understudy/doctor/finding.h"

namespace understudy::launcher {

/// Calls `told` with each finding as soon as it is known. Throws std::system_error if no files can be written.
std::vector<NamedFinding> deep_findings(const std::function<void(const NamedFinding&)>& told);

}  // namespace understudy::launcher
