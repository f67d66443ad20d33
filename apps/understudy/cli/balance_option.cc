// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/balance_option.h"

namespace understudy::launcher {

void add_balance_option(CLI::App& subcommand, std::string& balance) {
  subcommand
      .add_option("--balance", balance,
                  "load balancing, by which slow nodes hand blocks of a volume to faster ones: off (default), "
                  "muller (one slice at a time, Mueller et al. 2006) or predicted (as many blocks as are "
                  "expected to even out the rendering times)")
      ->check(CLI::IsMember({"off", "muller", "predicted"}).description(""))
      ->type_name("off|muller|predicted");
}

}  // namespace understudy::launcher
