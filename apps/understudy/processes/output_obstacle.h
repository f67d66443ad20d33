// SPDX-License-Identifier: Apache-2.0
// Whether what a command writes in the end, or frame by frame, can be written: found out before it begins.
#pragma once

#include <string>

namespace understudy::launcher {

/// Why the file `path` cannot be made or overwritten; empty: it can. Nothing is opened or changed.
std::string obstacle_to_writing(const std::string& path);

/// Makes `folder` where it is not there. Why no file can be made in it; empty: it can.
std::string obstacle_to_writing_into(const std::string& folder);

}  // namespace understudy::launcher
