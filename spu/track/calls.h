// SPDX-License-Identifier: Apache-2.0
// What a command means to those who watch the stream, decided by its name in the registry.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class CallKind {
  other,            ///< changes state or reads something
  vertex,           ///< vertices and current vertex attributes: legal between glBegin and glEnd
  draw,             ///< glBegin, glEnd, glDrawArrays and relatives
  bound_texture,    ///< changes the contents of the texture bound to a target of the active unit
  unknown_texture,  ///< changes the contents of some texture
  not_compiled,     ///< executed at once even inside a display list, and without effect on it
};

CallKind kind_of(CallId call);

/// Whether glBegin and its relatives draw polygons with `mode`; points, lines and patches are none.
bool draws_polygons(GLenum mode);

/// 1, 2 or 3 for commands of kind bound_texture.
int texture_dimensions(CallId call);

}  // namespace understudy::spu
