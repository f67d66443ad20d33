// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/frame_account.h"

#include <fmt/format.h>

#include <cstdio>

#include "compositor/logging/log.h"
#include "spu/report/skipped_work.h"

namespace understudy::spu {

void report_frame(const FrameRecord& frame, bool explain) {
  count_frame(frame);
  if (explain && frame.substituted > 0)
    logging::log(logging::Level::info, "frame {}: {:.4g} ms; left out: {}", process_counters().frames.load(),
                 frame.time_ms, sentence_of(frame));
}

}  // namespace understudy::spu
