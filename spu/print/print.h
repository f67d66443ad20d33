// SPDX-License-Identifier: Apache-2.0
// The print unit: prints a readable line for every call.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "spu/unit_description.h"

namespace understudy::spu {

/// The output of all contexts of a process. An empty name means standard error.
class PrintFile {
 public:
  explicit PrintFile(const std::string& name);

  /// Returns the context's number, from 1.
  int begin_context();
  /// Writes a line immediately, because the application may end with the next call.
  void line(int context, std::string_view text);

 private:
  std::mutex mutex_;
  std::FILE* file_;  ///< never closed, as the application may call OpenGL until its very last instruction
  int contexts_ = 0;
};

class Print final : public Unit {
 public:
  static constexpr char tag = '>';

  /// `calls`: shell patterns of command names, separated by spaces. Frames are numbered from 1.
  Print(Chain& chain, const std::string& file, IntegerRange frames, const std::string& calls);

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void frame_ended(FrameEnd kind) override;

 private:
  struct Printed;

  void tell(CallId call, const std::uint64_t* words, std::uint64_t result);
  bool prints() const { return frame_ >= frames_.first && frame_ <= frames_.last; }

  Chain& chain_;
  PrintFile& file_;
  const int context_;
  const IntegerRange frames_;
  std::vector<bool> wanted_;  ///< by call
  std::int64_t frame_ = 1;    ///< the current frame
  fmt::memory_buffer line_;
};

extern const UnitDescription print_description;

}  // namespace understudy::spu
