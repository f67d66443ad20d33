// SPDX-License-Identifier: Apache-2.0
// Whether a stream is between glBegin and glEnd, where OpenGL answers no questions. Display lists may begin
// what others end, so what each leaves behind is kept.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

class BeginAndEnd {
 public:
  /// Returns true when the call was a list that has begun or ended something.
  bool follow(CallId call, const std::uint64_t* words);
  bool inside() const { return inside_; }

 private:
  bool inside_ = false;
  /// What lists leave behind, once executed: inside, outside, or all as it was.
  std::map<GLuint, std::optional<bool>> list_effects_;
  GLuint list_ = 0;  ///< being defined
  std::optional<bool> list_leaves_;
  bool list_only_compiles_ = false;
  bool inside_before_list_ = false;
};

}  // namespace understudy::spu
