// SPDX-License-Identifier: Apache-2.0
// Which pre-integration tables the nodes have: requests refer to these megabytes instead of containing them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "compositor/service/limits.h"
#include "volume/classification.h"

namespace understudy::compositor {

class SentPreIntegrationTables {
 public:
  /// Returns the place of a table that is equal in every entry; null if there is none.
  std::optional<int> find(const volume::PreIntegrationTable& table);
  /// Returns a place for another table: an empty one, or that of the least recently used one.
  int make_place();
  /// To be called when the nodes have received the table for that place.
  void put(int place, const volume::PreIntegrationTable& table);

 private:
  struct Sent {
    std::optional<volume::PreIntegrationTable> table;
    std::uint64_t last_use = 0;
  };

  std::array<Sent, limits::max_kept_pre_integration_tables> sent_;
  std::uint64_t uses_ = 0;
};

}  // namespace understudy::compositor
