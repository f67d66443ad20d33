// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/sent_pre_integration_tables.h"

#include <algorithm>

namespace understudy::compositor {

std::optional<int> SentPreIntegrationTables::find(const volume::PreIntegrationTable& table) {
  for (std::size_t place = 0; place < sent_.size(); ++place) {
    Sent& sent = sent_[place];
    if (sent.table != table) continue;
    sent.last_use = ++uses_;
    return int(place);
  }
  return std::nullopt;
}

int SentPreIntegrationTables::make_place() {
  const auto oldest = std::ranges::min_element(sent_, {}, &Sent::last_use);
  *oldest = {};
  return int(oldest - sent_.begin());
}

void SentPreIntegrationTables::put(int place, const volume::PreIntegrationTable& table) {
  sent_[std::size_t(place)] = {table, ++uses_};
}

}  // namespace understudy::compositor
