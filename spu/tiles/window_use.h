// SPDX-License-Identifier: Apache-2.0
// Classifies calls by what they do with the pixels of a window, from their names in the registry.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class WindowUse {
  none,    ///< changes state or objects
  draws,   ///< writes pixels, restricted by the scissor test
  begins,  ///< glBegin
  ends,    ///< glEnd
  lists,   ///< glCallList, glCallLists: depends on the lists
  reads,   ///< glReadPixels and its robust forms
  copies,  ///< reads pixels into an object, or copies them within the framebuffer
  blits,   ///< reads and draws; never restricted to a tile, because windows are completed by blits
  asks,    ///< changes nothing; no later call refers to its answer
  pushes,  ///< glFlush, glFinish: all earlier calls are to be executed now
};

WindowUse window_use(CallId call);

/// Why the result of the call, or of what it prepares, cannot be assembled from tiles; otherwise null.
const char* beyond_tiles(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
