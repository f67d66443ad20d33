// SPDX-License-Identifier: Apache-2.0
// Rectangles of pixels as fields of messages.
#pragma once

#include <string>

#include "compositor/transport/wire.h"
#include "volume/rect.h"

namespace understudy::compositor {

void write(Writer& out, const volume::Rect& rect);
/// Throws MalformedMessage if it is no rectangle of a viewport (limits.h).
volume::Rect read_rect(Reader& in, const std::string& name);
/// Likewise, for a rectangle whose pixels will be allocated: at most limits::max_window_pixels.
volume::Rect read_pixels(Reader& in, const std::string& name);

}  // namespace understudy::compositor
