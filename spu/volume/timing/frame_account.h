// SPDX-License-Identifier: Apache-2.0
// One context's part of a frame: where its time goes, and which work it did and skipped.
#pragma once

#include "spu/volume/context/context.h"
#include "spu/volume/timing/frame_clock.h"
#include "spu/volume/timing/frame_ledger.h"

namespace understudy::spu {

/// Passed to every stage of the volume unit, which counts its work here.
class FrameAccount {
 public:
  /// `owner` identifies the context in the ledger.
  FrameAccount(const GlContext& context, FrameLedger& ledger, FrameLedger::Context owner)
      : context_(context), ledger_(ledger), owner_(owner) {}

  FrameClock& clock() { return clock_; }

  /// Applies `change` to the record of what this context did since the last frame end.
  template <class Change>
  void note(Change change) {
    GLint framebuffer = 0;
    context_.gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    ledger_.note(owner_, framebuffer == 0, change);
  }

  /// Frames ended so far, in all contexts.
  std::uint64_t frames() const { return ledger_.frames(); }

 private:
  const GlContext& context_;
  FrameLedger& ledger_;
  FrameLedger::Context owner_;
  FrameClock clock_;
};

/// Counts a frame that has ended; with `explain`, prints it on stderr if something was substituted.
void report_frame(const FrameRecord& frame, bool explain);

}  // namespace understudy::spu
