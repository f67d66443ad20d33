// SPDX-License-Identifier: Apache-2.0
// The origin of figures, so that a report can be understood later and on other machines.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace understudy::launcher {

/// Returns {"version", "commit", "compiler", "instruction_set", "command": [word…], "machine": {"name",
/// "processor", "processors", "memory_bytes"}, "time"} of this process, now; the time is UTC in ISO 8601.
nlohmann::ordered_json origin();

}  // namespace understudy::launcher
