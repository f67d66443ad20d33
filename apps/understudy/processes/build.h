// SPDX-License-Identifier: Apache-2.0
// What this program was built from.
#pragma once

#include <string>

namespace understudy::launcher {

std::string version_number();
/// The commit of the checkout; "no commit" for a source archive.
std::string commit();
std::string compiler();

}  // namespace understudy::launcher
