// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/turns.h"

#include <algorithm>

namespace understudy::compositor {

void Turns::served(std::uint64_t client, Deadline begun, Deadline done) {
  const auto others = std::ranges::count_if(clients_, [&](const auto& entry) {
    return entry.first != client && entry.second.served + limits::active_within >= begun;
  });
  const auto took = done - begun;
  const Deadline::duration rest = took < limits::short_request ? Deadline::duration(0) : took * others;
  clients_[client] = {done, done + std::min<Deadline::duration>(rest, limits::longest_rest)};
}

Deadline Turns::rests_until(std::uint64_t client) const {
  const auto found = clients_.find(client);
  return found == clients_.end() ? Deadline() : found->second.rests_until;
}

}  // namespace understudy::compositor
