// SPDX-License-Identifier: Apache-2.0
// What a call is to somebody who wants to know the state behind it, and not the images before.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class CallRole {
  state,      ///< changes state or objects, or is not known well enough: it is kept
  begin,      ///< glBegin
  end,        ///< glEnd
  vertex,     ///< draws a vertex between the two
  attribute,  ///< the current colour, normal, coordinate: only the last one counts
  draw,       ///< draws, clears or copies images, and changes nothing but the framebuffer
  call_list,  ///< glCallList, glCallLists
  read,       ///< reads images, into memory or into a buffer
  ask,        ///< asks what no later call refers to; waits
};

CallRole role_of(CallId call);

}  // namespace understudy::spu
