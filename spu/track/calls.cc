// SPDX-License-Identifier: Apache-2.0
#include "spu/track/calls.h"

#include <array>
#include <string_view>

#include "spu/track/call_names.h"

namespace understudy::spu {
namespace {

std::array<CallKind, call_count> all_kinds() {
  std::array<CallKind, call_count> kinds{};
  for (std::size_t i = 0; i < call_count; ++i) kinds[i] = kind_of_name(call_name(CallId(i)));
  return kinds;
}

}  // namespace

CallKind kind_of(CallId call) {
  static const std::array<CallKind, call_count> kinds = all_kinds();
  return kinds[std::size_t(call)];
}

bool draws_polygons(GLenum mode) {
  return mode >= GL_TRIANGLES && mode <= GL_POLYGON;
}

int texture_dimensions(CallId call) {
  const std::string_view name = call_name(call);
  for (int d = 1; d <= 3; ++d) {
    const char text[3] = {char('0' + d), 'D', 0};
    if (name.find(text) != std::string_view::npos) return d;
  }
  return 2;
}

}  // namespace understudy::spu
