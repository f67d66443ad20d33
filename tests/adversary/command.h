// SPDX-License-Identifier: Apache-2.0
// Programs that the judge runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace adversary {

/// Runs it with `environment` (NAME=VALUE) added to this process's, standard output and error into `log`.
/// Returns the exit status, or 128 + signal.
int run_command(const std::vector<std::string>& command, const std::filesystem::path& log,
                const std::vector<std::string>& environment = {});

}  // namespace adversary
