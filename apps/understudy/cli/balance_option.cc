// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/balance_option.h"

namespace understudy::launcher {

void add_balance_option(CLI::App& subcommand, std::string& balance) {
  subcommand
      .add_option("--balance", balance,
                  "whether slow nodes give blocks of their volumes to others: off (default), muller (one slice "
                  "at a time, Mueller et al. 2006) or predicted (as many as should even out the times)")
      ->check(CLI::IsMember({"off", "muller", "predicted"}).description(""))
      ->type_name("off|muller|predicted");
}

}  // namespace understudy::launcher
