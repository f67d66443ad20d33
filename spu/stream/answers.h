// SPDX-License-Identifier: Apache-2.0
// Identifies the calls whose answers later calls of a stream refer to.
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

/// Whether the call returns names of objects through this argument.
inline bool answers_names(const ParameterShape& parameter) {
  return parameter.pointer == 1 && !parameter.input && parameter.object != ObjectKind::none;
}

inline bool answers_names(CallId call) {
  for (const ParameterShape& parameter : call_shape(call).parameters()) {
    if (answers_names(parameter)) return true;
  }
  return false;
}

/// Whether the call's answer here must be kept until the stream reports the recorded answer.
inline bool names_something(CallId call) {
  return call_shape(call).result_object != ObjectKind::none || is_location_query(call) || maps_a_buffer(call) ||
         answers_names(call);
}

}  // namespace understudy::spu
