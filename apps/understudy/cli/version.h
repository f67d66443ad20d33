// SPDX-License-Identifier: Apache-2.0
// `understudy --version`: what was built, from which commit, and what it uses on this machine.
#pragma once

#include <string>

namespace understudy::launcher {

/// Returns a few lines for bug reports.
std::string version_text();

}  // namespace understudy::launcher
