// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/sort_option.h"

namespace understudy::launcher {

void add_sort_option(CLI::App& subcommand, std::string& sort) {
  subcommand
      .add_option(
          "--sort", sort,
          "what nodes divide: the volume (last, default), the image, with the whole volume on every node "
          "(first; Moloney et al. 2007), both (hybrid: groups of nodes divide the image, and inside a "
          "group the volume), or auto: the image, by as few nodes to a group as have memory for it")
      ->check(CLI::IsMember({"first", "last", "hybrid", "auto"}).description(""))
      ->type_name("last|first|hybrid|auto");
}

}  // namespace understudy::launcher
