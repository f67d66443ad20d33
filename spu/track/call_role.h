// SPDX-License-Identifier: Apache-2.0
// The role of a call for a tool that needs the state after it, and not the images before.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class CallRole {
  state,      ///< changes state or objects, or has an unknown effect: it is kept
  begin,      ///< glBegin
  end,        ///< glEnd
  vertex,     ///< adds a vertex between glBegin and glEnd
  attribute,  ///< sets the current colour, normal or coordinate: only the last one counts
  draw,       ///< draws, clears or copies images, and changes only the framebuffer
  call_list,  ///< glCallList, glCallLists
  read,       ///< reads images, into memory or into a buffer
  ask,        ///< makes a query whose answer no later call refers to, or waits
};

CallRole role_of(CallId call);

}  // namespace understudy::spu
