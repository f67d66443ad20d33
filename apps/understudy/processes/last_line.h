// SPDX-License-Identifier: Apache-2.0
// What a program said last.
#pragma once

#include <filesystem>
#include <string>

namespace understudy::launcher {

/// The last line of a file that is not empty, without control characters: programs say last what went wrong.
std::string last_line(const std::filesystem::path& file);

}  // namespace understudy::launcher
