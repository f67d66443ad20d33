// SPDX-License-Identifier: Apache-2.0
// The status of running viewers, as text and as JSON for scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "apps/understudy/control/running_viewers.h"

namespace understudy::launcher {

/// What `ctl list` tells of a viewer.
nlohmann::ordered_json summary_of(const RunningViewer& viewer);
/// The same as two or more lines.
std::string summary_text(const RunningViewer& viewer);

/// The report of the run so far, with what is switched on under `control`.
nlohmann::ordered_json status_of(const RunningViewer& viewer);

/// "substitution off, tint off, no budget"; "error 0.0078".
std::string settings_text(const nlohmann::ordered_json& control);

}  // namespace understudy::launcher
