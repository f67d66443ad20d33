#include "compositor/service/sent_pair_tables.h"

#include <algorithm>

namespace understudy::compositor {

std::optional<int> SentPairTables::find(const volume::PairTable& table) {
  for (std::size_t place = 0; place < sent_.size(); ++place) {
    Sent& sent = sent_[place];
    if (sent.table != table) continue;
    sent.last_use = ++uses_;
    return int(place);
  }
  return std::nullopt;
}

int SentPairTables::make_place() {
  const auto oldest = std::ranges::min_element(sent_, {}, &Sent::last_use);
  *oldest = {};
  return int(oldest - sent_.begin());
}

void SentPairTables::put(int place, const volume::PairTable& table) {
  sent_[std::size_t(place)] = {table, ++uses_};
}

}  // namespace understudy::compositor
