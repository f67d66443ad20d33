// SPDX-License-Identifier: Apache-2.0
// What a call does with the pixels of a window, by its name in the registry.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class WindowUse {
  none,    ///< changes state or objects
  draws,   ///< writes pixels, and the scissor test limits where
  begins,  ///< glBegin
  ends,    ///< glEnd
  lists,   ///< glCallList, glCallLists: whatever was compiled
  reads,   ///< glReadPixels and its robust forms
  copies,  ///< reads pixels into an object, or to another place
  blits,   ///< reads and draws; never limited to a tile, as that is how a window becomes whole
  asks,    ///< changes nothing, and answers what no later call refers to
  pushes,  ///< glFlush, glFinish: whatever was called is to be done now
};

WindowUse window_use(CallId call);

/// Why what the call does, or prepares, cannot be put together from tiles; null for all others.
const char* beyond_tiles(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
