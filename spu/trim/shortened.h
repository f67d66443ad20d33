// SPDX-License-Identifier: Apache-2.0
// The shorter trace as it is written: records of the prefix by their actions, then the frames behind the cut.
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

  /// A record before the cut.
  void take(const Record& record, RecordAction action);
  /// At the cut: records that were made for it.
  void take_all(const Records& records);
  /// A record of the frames that stay; they are numbered from 1.
  void take(const Record& record);
  /// Writes what is left.
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
