// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/rect_fields.h"

#include <fmt/format.h>

#include "compositor/service/limits.h"

namespace understudy::compositor {

using volume::Rect;

void write(Writer& out, const Rect& rect) {
  for (const int value : {rect.x, rect.y, rect.width, rect.height}) out.integer(value);
}

Rect read_rect(Reader& in, const std::string& name) {
  Rect rect;
  rect.x = in.small(name + ".x", -limits::max_viewport_offset, limits::max_viewport_offset);
  rect.y = in.small(name + ".y", -limits::max_viewport_offset, limits::max_viewport_offset);
  rect.width = in.small(name + ".width", 0, limits::max_viewport_extent);
  rect.height = in.small(name + ".height", 0, limits::max_viewport_extent);
  return rect;
}

Rect read_pixels(Reader& in, const std::string& name) {
  const Rect rect = read_rect(in, name);
  if (rect.pixels() > limits::max_window_pixels)
    in.fail(name, fmt::format("has {} pixels, more than {}", rect.pixels(), limits::max_window_pixels));
  return rect;
}

}  // namespace understudy::compositor
