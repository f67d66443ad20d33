// SPDX-License-Identifier: Apache-2.0
// A mock driver: every command of the table exists, records its call and returns a preset value.
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

/// At most one at a time: its functions use the instance that was made last.
class MockDriver {
 public:
  MockDriver();
  ~MockDriver();
  MockDriver(const MockDriver&) = delete;
  MockDriver& operator=(const MockDriver&) = delete;

  const DispatchTable& table() const { return table_; }
  /// For functions that preset values cannot express, such as writing through a pointer.
  DispatchTable& slots() { return table_; }

  void lacks(CallId call) { set_slot(table_, call, nullptr); }
  void answers(CallId call, std::uint64_t result) { results_[call] = result; }

  const std::vector<MockCall>& calls() const { return calls_; }
  /// Only the ids of the calls.
  std::vector<CallId> called() const;
  std::size_t count(CallId call) const;
  void forget() { calls_.clear(); }

  /// Counts calls instead of recording them, so that a call allocates no memory.
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

/// A switch_table for the chains of tests: installed() is the table that the application calls.
const DispatchTable& installed();
void install(const DispatchTable* table);

}  // namespace understudy::spu::testing
