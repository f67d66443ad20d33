// SPDX-License-Identifier: Apache-2.0
// A driver without a driver: every command of the table is there, notes its call and answers what it was told
// to.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "dispatch/call_id.h"

namespace understudy::spu::testing {

struct MockCall {
  CallId call;
  std::vector<std::uint64_t> words;  ///< the arguments, as in dispatch/call_words.h
  bool operator==(const MockCall&) const = default;
};

/// One at a time: its functions find it by being the last one that was made.
class MockDriver {
 public:
  MockDriver();
  ~MockDriver();
  MockDriver(const MockDriver&) = delete;
  MockDriver& operator=(const MockDriver&) = delete;

  const DispatchTable& table() const { return table_; }
  /// For what a table of words cannot do, such as writing through a pointer.
  DispatchTable& slots() { return table_; }

  void lacks(CallId call) { set_slot(table_, call, nullptr); }
  void answers(CallId call, std::uint64_t result) { results_[call] = result; }

  const std::vector<MockCall>& calls() const { return calls_; }
  /// The numbers of the calls alone.
  std::vector<CallId> called() const;
  std::size_t count(CallId call) const;
  void forget() { calls_.clear(); }

  /// Counts instead of noting: then a call allocates no memory.
  void only_count() { only_count_ = true; }
  std::uint64_t counted() const { return counted_; }

 private:
  struct Note;

  DispatchTable table_{};
  std::map<CallId, std::uint64_t> results_;
  std::vector<MockCall> calls_;
  bool only_count_ = false;
  std::uint64_t counted_ = 0;
  MockDriver* before_;
};

/// A switch_table for chains in tests: what is installed is what the application calls.
const DispatchTable& installed();
void install(const DispatchTable* table);

}  // namespace understudy::spu::testing
