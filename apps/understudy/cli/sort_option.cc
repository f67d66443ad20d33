// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/sort_option.h"

namespace understudy::launcher {

void add_sort_option(CLI::App& subcommand, std::string& sort) {
  subcommand
      .add_option("--sort", sort,
                  "division of the work among nodes: of the volume (last), of the image, with the whole volume "
                  "on every machine (first; Moloney et al. 2007), of both (hybrid: groups of nodes divide the "
                  "image, and the nodes of a group the volume), or auto (default): of the image, and of the "
                  "volume among as few machines as have memory for it; with --balance, of the volume")
      ->check(CLI::IsMember({"last", "first", "hybrid", "auto"}).description(""))
      ->type_name("last|first|hybrid|auto");
}

}  // namespace understudy::launcher
