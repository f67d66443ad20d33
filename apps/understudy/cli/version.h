// SPDX-License-Identifier: Apache-2.0
// `understudy --version`: what was built, of which commit, and what it uses here.
#pragma once

#include <string>

namespace understudy::launcher {

/// A few lines, for people who report what went wrong.
std::string version_text();

}  // namespace understudy::launcher
