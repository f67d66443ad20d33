// SPDX-License-Identifier: Apache-2.0
// The kind of a command for units that watch the stream, determined by its name in the registry.
#pragma once

#include "dispatch/call_id.h"

namespace understudy::spu {

enum class CallKind {
  other,            ///< changes state or reads something
  vertex,           ///< vertices and current vertex attributes: legal between glBegin and glEnd
  draw,             ///< glBegin, glEnd, glDrawArrays and similar calls
  bound_texture,    ///< changes the contents of the texture bound to a target of the active unit
  unknown_texture,  ///< changes the contents of a texture that is not known
  not_compiled,     ///< executed immediately even inside a display list, and not compiled into it
};

CallKind kind_of(CallId call);

/// Whether glBegin and draw calls with `mode` draw polygons; points, lines and patches are not polygons.
bool draws_polygons(GLenum mode);

/// 1, 2 or 3 for commands of kind bound_texture.
int texture_dimensions(CallId call);

}  // namespace understudy::spu
