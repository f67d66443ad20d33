// SPDX-License-Identifier: Apache-2.0
// `understudy --version`: what was built, of which commit, and what it uses here.
#pragma once

#include <string>

namespace understudy::launcher {

/// As 0.1.0.
std::string version_number();
/// A few lines, for people who report what went wrong.
std::string version_text();

}  // namespace understudy::launcher
