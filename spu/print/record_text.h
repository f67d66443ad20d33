// SPDX-License-Identifier: Apache-2.0
// Records of a stream as a person would write them, one line each:
//
//   glGenTextures(n = 2, textures = {3, 4})
//   frame 7, 512 x 384
//
// A call that answers something is told when its answer is known, which is the next record of its thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "spu/stream/decode.h"
#include "spu/stream/record.h"

namespace understudy::spu {

class RecordText {
 public:
  /// Lines go to `line`, without their end. `wants_call` says which calls are told; without it all, and the
  /// events too.
  explicit RecordText(std::function<void(std::string_view)> line,
                      std::function<bool(std::string_view)> wants_call = {});

  void tell(const Record& record);
  /// What waits for an answer that does not come any more.
  void finish();

 private:
  std::string call_line(const Record& record, const Record* answers);
  void tell_call(const Record& record);
  void tell_waiting(std::uint64_t thread, const Record* answers);
  void tell_arrays(const Record& record);

  std::function<void(std::string_view)> line_;
  std::function<bool(std::string_view)> wants_call_;
  Decoder decoder_{StreamOrigin::elsewhere, nullptr};
  std::uint64_t thread_ = 0;
  /// By thread, the words of a call whose answer may follow; its block may be gone by then.
  std::map<std::uint64_t, std::vector<std::uint64_t>> waiting_;
};

}  // namespace understudy::spu
