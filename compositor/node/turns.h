// SPDX-License-Identifier: Apache-2.0
// Fair turns: after a request that took long a client rests, so that others who ask for images have as much
// of the nodes' time as it has.
#pragma once

#include <cstdint>
#include <map>

#include "compositor/service/limits.h"
#include "compositor/transport/socket.h"

namespace understudy::compositor {

class Turns {
 public:
  /// A request of `client` was in hand from `begun` to `done`. It rests for that time once for each other
  /// client that has asked for something since limits::active_within before it.
  void served(std::uint64_t client, Deadline begun, Deadline done);
  /// When `client` may be heard again.
  Deadline rests_until(std::uint64_t client) const;
  void forget(std::uint64_t client) { clients_.erase(client); }

 private:
  struct Client {
    Deadline served{};
    Deadline rests_until{};
  };

  std::map<std::uint64_t, Client> clients_;
};

}  // namespace understudy::compositor
