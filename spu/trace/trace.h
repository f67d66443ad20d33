// SPDX-License-Identifier: Apache-2.0
// The trace unit: records every call of a context in the process's recording, with the memory that it reads and
// its answer.
#pragma once

#include <cstdint>

#include "spu/trace/call_recorder.h"
#include "spu/trace/recording.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Trace final : public Unit {
 public:
  static constexpr char tag = 'r';

  Trace(Chain& chain, Recording& recording);

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void made_current() override;
  void left() override;
  void frame_ended(FrameEnd kind) override;
  void abandon() override;
  void process_ends() override { recording_.flush(true); }

  std::uint64_t call(CallId call, const std::uint64_t* words);

 private:
  struct Extent {
    std::uint64_t width = 0;
    std::uint64_t height = 0;
    bool operator==(const Extent&) const = default;
  };

  void introduce_context();
  void tell_current();
  void note_viewport(const std::uint64_t* words);

  Chain& chain_;
  Recording& recording_;
  CallRecorder recorder_;
  bool introduced_ = false;
  // Only the window system knows the size of the drawable, and querying it may end in an X error. OpenGL's
  // initial viewport has that size, and applications set a viewport of the new size whenever it changes: the
  // largest viewport of a frame is taken as the size of the drawable.
  Extent drawable_;
  Extent in_frame_;
};

extern const UnitDescription trace_description;

}  // namespace understudy::spu
