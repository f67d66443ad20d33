// SPDX-License-Identifier: Apache-2.0
// Calls for buffers that are mapped into the application's memory.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

inline bool unmaps_buffer(CallId call) {
  return call == CallId::UnmapBuffer || call == CallId::UnmapBufferARB || call == CallId::UnmapNamedBuffer ||
         call == CallId::UnmapNamedBufferEXT;
}

}  // namespace understudy::spu
