// SPDX-License-Identifier: Apache-2.0
// Who takes what pack has packed: unpack in the same chain, or link, whose calls are made elsewhere.
#pragma once

#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// How soon a call must be handed on.
enum class HandOn {
  later,
  now,
  and_wait,  ///< its result, or what it writes, is wanted
};

/// A call whose records are the last ones of those that are handed on.
struct PackedCall {
  CallId call{};
  const std::uint64_t* words = nullptr;
};

class RecordTaker {
 public:
  virtual ~RecordTaker() = default;

  /// The result of a call that need not be packed.
  virtual std::optional<std::uint64_t> known(CallId /*call*/, const std::uint64_t* /*words*/) { return {}; }
  /// Before a call is packed: appends what must be known where it is made.
  virtual void before(CallId /*call*/, const std::uint64_t* /*words*/, Records& /*to*/) {}
  virtual HandOn when(CallId call, bool inside_begin) = 0;
  /// The calls are made in this process, so addresses mean something there, and what the encoder asks may
  /// depend on calls that are still packed.
  virtual bool in_this_process() const { return true; }
  /// Has the calls made, in order. Answers the result of `last`; null: nobody waits.
  virtual std::uint64_t take(const Records& records, const PackedCall* last) = 0;
};

}  // namespace understudy::spu
