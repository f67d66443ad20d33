// SPDX-License-Identifier: Apache-2.0
// Which kinds of state the application has set: pairs of a command and its enumerants, such as glEnable of
// GL_ALPHA_TEST or glTexParameterf of GL_TEXTURE_MIN_LOD.
//
// The schedule of comparisons knows the state that colours may depend on one by one (verification/schedule.h).
// A kind of state that the application has never set before may be one that is missing there. The next image is
// therefore compared whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

class StateKinds {
 public:
  /// The application makes `call`; `words` are its arguments in the form of AsWords.
  void note(CallId call, const std::uint64_t* words);
  /// How many kinds were set so far.
  std::size_t count() const { return kinds_.size(); }

 private:
  std::unordered_set<std::uint64_t> kinds_;
  std::uint64_t latest_ = 0;  ///< most calls come in groups of one kind
};

/// Fills the slots of the commands that may set state, for the phase watching.
void fill_state_kind_slots(DispatchTable& table);

}  // namespace understudy::spu
