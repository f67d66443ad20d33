// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/partition_option.h"

namespace understudy::launcher {

void add_partition_option(CLI::App& subcommand, std::string& partition) {
  subcommand
      .add_option("--partition", partition,
                  "partition of a volume that nodes divide: blocks (equal numbers of blocks), factors (rows "
                  "and columns of equal boxes, Magallon et al. 2001), cost (equal numbers of samples that the "
                  "transfer function makes visible, computed anew when it changes; with --sort last) or auto "
                  "(default): cost where possible, otherwise blocks")
      ->check(CLI::IsMember({"blocks", "factors", "cost", "auto"}).description(""))
      ->type_name("blocks|factors|cost|auto");
}

}  // namespace understudy::launcher
