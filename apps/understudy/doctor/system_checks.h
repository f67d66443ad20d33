// SPDX-License-Identifier: Apache-2.0
// Which parts of the system are there: X, OpenGL's window systems, MPI, the sandbox, and the parts of
// Understudy.
#pragma once

#include <functional>
#include <vector>

#include "apps/understudy/doctor/finding.h"

namespace understudy::launcher {

/// `told` hears each as soon as it is known.
std::vector<NamedFinding> system_findings(const std::function<void(const NamedFinding&)>& told);

}  // namespace understudy::launcher
