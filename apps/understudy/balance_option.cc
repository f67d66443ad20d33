#include "apps/understudy/balance_option.h"

namespace understudy::launcher {

void add_balance_option(CLI::App& subcommand, std::string& balance) {
  subcommand
      .add_option(
          "--balance", balance,
          "whether nodes that take longer give blocks of their volumes to others: a slice at a time, as "
          "Mueller "
          "et al. did in 2006, or as many as are predicted to even the nodes' times out; off, unless asked")
      ->check(CLI::IsMember({"off", "muller", "predicted"}).description(""))
      ->type_name("off|muller|predicted");
}

}  // namespace understudy::launcher
