// SPDX-License-Identifier: Apache-2.0
// Whether a viewer's volume is substituted here, by each way that there is: the bundled viewer is run, off
// screen, on a small volume.
#pragma once

#include <functional>
#include <vector>

#include "apps/understudy/doctor/finding.h"

namespace understudy::launcher {

/// `told` hears each as soon as it is known. Throws std::system_error where no files can be written.
std::vector<NamedFinding> deep_findings(const std::function<void(const NamedFinding&)>& told);

}  // namespace understudy::launcher
