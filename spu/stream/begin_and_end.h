// SPDX-License-Identifier: Apache-2.0
// Tracks whether a stream is between glBegin and glEnd, where OpenGL answers no queries. A display list may
// begin what another one ends, so the final state of each list is recorded.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

class BeginAndEnd {
 public:
  /// Returns true if the call executed a list that left it inside or outside glBegin/glEnd.
  bool follow(CallId call, const std::uint64_t* words);
  bool inside() const { return inside_; }

 private:
  bool inside_ = false;
  /// The state after a list was executed: inside, outside, or unchanged.
  std::map<GLuint, std::optional<bool>> list_effects_;
  GLuint list_ = 0;  ///< the list being defined
  std::optional<bool> list_leaves_;
  bool list_only_compiles_ = false;
  bool inside_before_list_ = false;
};

}  // namespace understudy::spu
