// SPDX-License-Identifier: Apache-2.0
// Which pre-integration tables the nodes have: these are megabytes, and requests name them instead of bringing
// them along.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "compositor/service/limits.h"
#include "volume/classification.h"

namespace understudy::compositor {

class SentPreIntegrationTables {
 public:
  /// The place of a table that is equal in every entry.
  std::optional<int> find(const volume::PreIntegrationTable& table);
  /// The place for another table: empty, or that of the table not asked for longest. What was there is
  /// forgotten.
  int make_place();
  /// The nodes have taken in the table for that place.
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
