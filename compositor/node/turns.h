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
  /// A request of `client` was in hand from `begun` to `done`; to be refused counts as limits::short_request at
  /// least. It rests for that time once for each other client that has asked for something since
  /// limits::active_within before it. It rests for none that must rest itself meanwhile, and for one that was
  /// refused no longer than that took. For all together it rests no longer than for one, unless they use the
  /// nodes: limits::rest_for_use times what they have since its last turn is allowed, too.
  void served(std::uint64_t client, Deadline begun, Deadline done, bool refused);
  /// When `client` may be heard again. One that was not served yet could be one that has gone and has come
  /// again: it rests as long as any that has gone would, while others ask for something.
  Deadline rests_until(std::uint64_t client) const;
  void forget(std::uint64_t client);

 private:
  struct Client {
    Deadline heard{};  ///< last
    Deadline rests_until{};
    Deadline::duration time_for_it{};  ///< others rest for it no longer
    Deadline::duration used_then{};    ///< used_ at the end of its last turn
  };

  std::map<std::uint64_t, Client> clients_;
  Deadline::duration used_{};  ///< by all
  Deadline left_behind_{};     ///< the longest rest of those that have gone
};

}  // namespace understudy::compositor
