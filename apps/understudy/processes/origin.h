// SPDX-License-Identifier: Apache-2.0
// Where figures come from, so that a report can be understood later and elsewhere.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace understudy::launcher {

/// {"version", "commit", "compiler", "instruction_set", "command": [word…], "machine": {"name", "processor",
/// "processors", "memory_bytes"}, "time"}. Of this process, here and now; the time is UTC, ISO 8601.
nlohmann::ordered_json origin();

}  // namespace understudy::launcher
