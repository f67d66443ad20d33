// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/partition_option.h"

namespace understudy::launcher {

void add_partition_option(CLI::App& subcommand, std::string& partition) {
  subcommand
      .add_option("--partition", partition,
                  "where nodes that divide a volume cut it: blocks (as many for each), factors (in rows and "
                  "columns of equal boxes, Magallon et al. 2001), cost (by the samples that the transfer "
                  "function makes visible, cut anew when that changes; with --sort last), or auto (default): "
                  "cost where it can be had, else blocks")
      ->check(CLI::IsMember({"blocks", "factors", "cost", "auto"}).description(""))
      ->type_name("blocks|factors|cost|auto");
}

}  // namespace understudy::launcher
