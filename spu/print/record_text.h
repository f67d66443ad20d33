// SPDX-License-Identifier: Apache-2.0
// Records of a stream as readable lines, one per record:
//
//   glGenTextures(n = 2, textures = {3, 4})
//   frame 7, 512 x 384
//
// A call with an answer is printed once the answer is known, which is the next record of its thread.
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
  /// `line` gets each line without a line end. `wants_call` selects the calls to print; without it, all calls
  /// and events are printed.
  explicit RecordText(std::function<void(std::string_view)> line,
                      std::function<bool(std::string_view)> wants_call = {});

  void tell(const Record& record);
  /// Prints the calls that are still waiting for an answer.
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
  /// By thread, copies of the words of a call whose answer may follow, because its block may be gone by then.
  std::map<std::uint64_t, std::vector<std::uint64_t>> waiting_;
};

}  // namespace understudy::spu
