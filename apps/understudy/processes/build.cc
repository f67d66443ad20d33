// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/build.h"

#include "generated_commit.h"

namespace understudy::launcher {

std::string version_number() {
  return UNDERSTUDY_VERSION;
}

std::string commit() {
  return UNDERSTUDY_COMMIT;
}

std::string compiler() {
  return UNDERSTUDY_COMPILER;
}

}  // namespace understudy::launcher
