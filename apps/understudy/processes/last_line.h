// SPDX-License-Identifier: Apache-2.0
// The last line that a program wrote.
#pragma once

#include <filesystem>
#include <string>

namespace understudy::launcher {

/// Returns the last non-empty line of a file, without control characters: programs
/// usually report an error last.
std::string last_line(const std::filesystem::path& file);

}  // namespace understudy::launcher
