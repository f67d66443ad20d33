// SPDX-License-Identifier: Apache-2.0
// Writes the shortened trace: records of the prefix according to their actions, then the frames after the cut.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "dispatch/call_id.h"
#include "spu/stream/record.h"
#include "spu/stream/trace_file.h"
#include "spu/trim/prefix.h"

namespace understudy::spu {

class Shortened {
 public:
  /// Throws std::system_error.
  explicit Shortened(const std::filesystem::path& path) : writer_(path) {}

  /// Adds a record before the cut.
  void take(const Record& record, RecordAction action);
  /// Adds the records that were made for the cut.
  void take_all(const Records& records);
  /// Adds a record of the frames that are kept; they are numbered from 1.
  void take(const Record& record);
  /// Writes the remaining records.
  void finish();

 private:
  /// A display list of a share group.
  using ListName = std::pair<std::uint64_t, std::uint32_t>;

  struct ThreadState {
    std::uint64_t context = 0;
    bool compiling = false;
    ListName list;
  };

  void follow(const Record& record);
  void expand(const Record& record, int depth);
  void expand_list(std::uint32_t name, int depth);
  std::uint64_t group_of(std::uint64_t context) const;
  void write_when_large();

  TraceWriter writer_;
  Records records_;
  std::uint64_t frames_ = 0;
  std::uint32_t frames_in_block_ = 0;
  std::uint64_t thread_ = 0;
  std::map<std::uint64_t, ThreadState> threads_;
  std::map<std::uint64_t, std::uint64_t> shares_with_;
  std::map<std::uint64_t, std::uint32_t> list_base_;  ///< by context
  std::map<ListName, Records> lists_;
};

}  // namespace understudy::spu
