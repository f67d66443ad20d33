// SPDX-License-Identifier: Apache-2.0
// Fair turns: after a request that took long a client rests, so that other clients that ask for images get as
// much of the nodes' time.
#pragma once

#include <cstdint>
#include <map>

#include "compositor/service/limits.h"
#include "compositor/transport/socket.h"

namespace understudy::compositor {

class Turns {
 public:
  /// A request of `client` took from `begun` to `done`; a refused one counts as limits::short_request at least.
  /// The client rests for that time once for each other client that has asked for something within
  /// limits::active_within before `begun`. It does not rest for a client that must rest itself meanwhile, and
  /// for one that was refused no longer than that refusal took. For all together it rests no longer than for
  /// one, unless they use the nodes: limits::rest_for_use times what they have used since its last turn is
  /// allowed, too.
  void served(std::uint64_t client, Deadline begun, Deadline done, bool refused);
  /// Returns when `client` may be heard again. A client that was not served yet may be one that left and came
  /// back: it rests as long as any that has gone would, while others ask for something.
  Deadline rests_until(std::uint64_t client) const;
  void forget(std::uint64_t client);

 private:
  struct Client {
    Deadline heard{};  ///< end of its last turn
    Deadline rests_until{};
    Deadline::duration time_for_it{};  ///< others rest for it no longer than this
    Deadline::duration used_then{};    ///< used_ at the end of its last turn
  };

  std::map<std::uint64_t, Client> clients_;
  Deadline::duration used_{};  ///< by all clients
  Deadline left_behind_{};     ///< the longest rest of clients that have gone
};

}  // namespace understudy::compositor
