// SPDX-License-Identifier: Apache-2.0
// Checks which parts of the system are available: X, OpenGL's window systems, MPI, the sandbox,
// and the parts of Understudy.
#pragma once

#include <functional>
#include <vector>

#include "apps/understudy/doctor/finding.h"

namespace understudy::launcher {

/// Calls `told` with each finding as soon as it is known.
std::vector<NamedFinding> system_findings(const std::function<void(const NamedFinding&)>& told);

}  // namespace understudy::launcher
