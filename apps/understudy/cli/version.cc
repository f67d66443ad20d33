// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/version.h"

#include <fmt/format.h>

#include "apps/understudy/processes/build.h"
#include "apps/understudy/processes/installation.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::launcher {

std::string version_text() {
  const Installation here = this_installation();
  const std::string nodes =
      std::filesystem::exists(here.node()) ? here.node().string() : "not built (without MPI)";
  return fmt::format(
      "understudy {} ({}), built by {}\n"
      "  instruction set  {}\n"
      "  libraries        {}\n"
      "  render nodes     {}\n"
      "`understudy doctor` checks what works on this machine.",
      version_number(), commit(), compiler(), volume::instruction_set(), here.libraries.string(), nodes);
}

}  // namespace understudy::launcher
