// SPDX-License-Identifier: Apache-2.0
// `understudy run --trace FILE`: the viewer's chain begins with the unit that records it.
#pragma once

#include <filesystem>
#include <string>

#include "apps/understudy/cli/run.h"

namespace understudy::launcher {

/// Puts the trace unit before the chain of `arguments` and makes room for its file. Throws std::exception when
/// there is something that cannot be removed, or the chain is none.
void prepare_trace(RunArguments& arguments);

/// "t.ust: 20 frames, 1.4 MB; play it with: understudy replay t.ust"
std::string trace_summary(const std::filesystem::path& trace);

}  // namespace understudy::launcher
