// SPDX-License-Identifier: Apache-2.0
// `understudy run --trace FILE`: puts the trace unit, which records calls, at the
// beginning of the viewer's chain.
#pragma once

#include <filesystem>
#include <string>

#include "apps/understudy/cli/run.h"

namespace understudy::launcher {

/// Puts the trace unit before the chain of `arguments` and removes an old trace file. Throws std::exception if
/// the file cannot be removed or the chain is invalid.
void prepare_trace(RunArguments& arguments);

/// For example "t.ust: 20 frames, 1.4 MB; play it with: understudy replay t.ust".
std::string trace_summary(const std::filesystem::path& trace);

}  // namespace understudy::launcher
