// SPDX-License-Identifier: Apache-2.0
// The receiver of packed records: unpack in the same chain, or remote, whose calls are made in another process.
#pragma once

#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// How soon a call must be passed on.
enum class HandOn {
  later,
  now,
  and_wait,  ///< the caller needs its result, or what it writes
};

/// The call whose records are the last of those that are passed on.
struct PackedCall {
  CallId call{};
  const std::uint64_t* words = nullptr;
};

class RecordTaker {
 public:
  virtual ~RecordTaker() = default;

  /// The result of a call that need not be packed.
  virtual std::optional<std::uint64_t> known(CallId /*call*/, const std::uint64_t* /*words*/) { return {}; }
  /// Called before a call is packed: appends records that must precede it.
  virtual void before(CallId /*call*/, const std::uint64_t* /*words*/, Records& /*to*/) {}
  virtual HandOn when(CallId call, bool inside_begin) = 0;
  /// True if the calls are made in this process: addresses are valid there, and driver queries by the encoder
  /// may depend on calls that are still packed.
  virtual bool in_this_process() const { return true; }
  /// Has the calls made, in order. Returns the result of `last`; if `last` is null, nobody waits for a result.
  virtual std::uint64_t take(const Records& records, const PackedCall* last) = 0;
};

}  // namespace understudy::spu
