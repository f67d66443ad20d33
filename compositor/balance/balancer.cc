// SPDX-License-Identifier: Apache-2.0
#include "compositor/balance/balancer.h"

#include <array>
#include <utility>

namespace understudy::compositor {

bool set_balance(Balance& balance, std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Balance>, 3> names{
      {{"off", Balance::off}, {"muller", Balance::muller}, {"predicted", Balance::predicted}}};
  for (const auto& [known, value] : names) {
    if (known != name) continue;
    balance = value;
    return true;
  }
  return false;
}

namespace {

std::unique_ptr<Balancer> moving_balancer(Balance balance) {
  switch (balance) {
    case Balance::off:
      return nullptr;
    case Balance::muller:
      return muller_balancer();
    case Balance::predicted:
      return predicting_balancer();
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<Balancer> make_balancer(Balance balance, volume::PartitionMethod method) {
  auto moving = moving_balancer(balance);
  return method == volume::PartitionMethod::cost ? cutting_balancer(std::move(moving)) : std::move(moving);
}

}  // namespace understudy::compositor
