// SPDX-License-Identifier: Apache-2.0
// Checks, before a command begins, whether its outputs can be written.
#pragma once

#include <string>

namespace understudy::launcher {

/// Returns why the file `path` cannot be created or overwritten; empty: it can. Opens and changes nothing.
std::string obstacle_to_writing(const std::string& path);

/// Creates `folder` if it does not exist. Returns why no file can be created in it; empty: one can.
std::string obstacle_to_writing_into(const std::string& folder);

}  // namespace understudy::launcher
