// SPDX-License-Identifier: Apache-2.0
// Which calls answer something that later calls of a stream refer to.
#pragma once

#include "dispatch/call_shape.h"

namespace understudy::spu {

inline bool is_location_query(CallId call) {
  return call == CallId::GetUniformLocation || call == CallId::GetUniformLocationARB;
}

inline bool maps_a_buffer(CallId call) {
  return call == CallId::MapBuffer || call == CallId::MapBufferARB || call == CallId::MapBufferRange ||
         call == CallId::MapNamedBuffer || call == CallId::MapNamedBufferRange ||
         call == CallId::MapNamedBufferEXT || call == CallId::MapNamedBufferRangeEXT;
}

/// An argument through which the call answers names of objects.
inline bool answers_names(const ParameterShape& parameter) {
  return parameter.pointer == 1 && !parameter.input && parameter.object != ObjectKind::none;
}

inline bool answers_names(CallId call) {
  for (const ParameterShape& parameter : call_shape(call).parameters()) {
    if (answers_names(parameter)) return true;
  }
  return false;
}

/// Whether what the call answers here must be known when the stream tells what it had answered there.
inline bool names_something(CallId call) {
  return call_shape(call).result_object != ObjectKind::none || is_location_query(call) || maps_a_buffer(call) ||
         answers_names(call);
}

}  // namespace understudy::spu
