// SPDX-License-Identifier: Apache-2.0
#include "tests/spu/mock_driver.h"

#include <algorithm>

#include "dispatch/call_words.h"

namespace understudy::spu::testing {
namespace {

MockDriver* newest = nullptr;
const DispatchTable* installed_table = nullptr;

}  // namespace

struct MockDriver::Note {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    MockDriver& mock = *newest;
    ++mock.counted_;
    if (!mock.only_count_) mock.calls_.push_back({call, {words, words + call_shape(call).parameter_count}});
    const auto result = mock.results_.find(call);
    return result != mock.results_.end() ? result->second : 0;
  }
};

MockDriver::MockDriver() : before_(newest) {
  AsWords<Note>::fill(table_);
  newest = this;
}

MockDriver::~MockDriver() {
  newest = before_;
}

std::vector<CallId> MockDriver::called() const {
  std::vector<CallId> ids;
  for (const MockCall& call : calls_) ids.push_back(call.call);
  return ids;
}

std::size_t MockDriver::count(CallId call) const {
  return std::size_t(
      std::count_if(calls_.begin(), calls_.end(), [&](const MockCall& made) { return made.call == call; }));
}

const DispatchTable& installed() {
  return *installed_table;
}

void install(const DispatchTable* table) {
  installed_table = table;
}

}  // namespace understudy::spu::testing
