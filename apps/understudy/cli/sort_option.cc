// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/sort_option.h"

namespace understudy::launcher {

void add_sort_option(CLI::App& subcommand, std::string& sort) {
  subcommand
      .add_option(
          "--sort", sort,
          "what nodes divide: the volume (last), the image, with the whole volume on every machine (first; "
          "Moloney et al. 2007), both (hybrid: groups of nodes divide the image, and inside a group the "
          "volume), or auto (default): the image, and the volume among as few machines as have memory for "
          "it; with --balance, the volume")
      ->check(CLI::IsMember({"last", "first", "hybrid", "auto"}).description(""))
      ->type_name("last|first|hybrid|auto");
}

}  // namespace understudy::launcher
