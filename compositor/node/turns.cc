// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/turns.h"

#include <algorithm>

namespace understudy::compositor {

void Turns::served(std::uint64_t client, Deadline begun, Deadline done, bool refused) {
  using Duration = Deadline::duration;
  const Duration took = done - begun;
  const Duration counted = refused ? std::max<Duration>(took, limits::short_request) : took;
  Duration rest{};
  for (const auto& [number, other] : clients_) {
    if (counted < limits::short_request || number == client || other.heard + limits::active_within < begun)
      continue;
    const Duration its_rest = std::max(other.rests_until - done, Duration());
    rest += std::min(std::max(counted - its_rest, Duration()), other.time_for_it);
  }
  // Without this limit many clients that ask for next to nothing would leave the nodes idle.
  const Duration by_others = used_ - clients_[client].used_then;
  rest = std::min(rest, std::max(counted, limits::rest_for_use * by_others));
  used_ += took;
  clients_[client] = {done, done + std::min<Duration>(rest, limits::longest_rest),
                      refused ? took : Duration::max(), used_};
}

Deadline Turns::rests_until(std::uint64_t client) const {
  const auto found = clients_.find(client);
  if (found != clients_.end()) return found->second.rests_until;
  if (clients_.empty()) return {};
  Deadline heard{};
  for (const auto& [number, other] : clients_) heard = std::max(heard, other.heard);
  return std::min(left_behind_, heard + limits::active_within);
}

void Turns::forget(std::uint64_t client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  left_behind_ = std::max(left_behind_, found->second.rests_until);
  clients_.erase(found);
}

}  // namespace understudy::compositor
