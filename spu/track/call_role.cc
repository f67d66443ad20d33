// SPDX-License-Identifier: Apache-2.0
#include "spu/track/call_role.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "spu/stream/answers.h"
#include "spu/track/calls.h"

namespace understudy::spu {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array draw_prefixes = {"glDraw"sv,        "glMultiDraw"sv,
                                      "glRect"sv,        "glEvalMesh"sv,
                                      "glBlit"sv,        "glCopyPixels"sv,
                                      "glAccum"sv,       "glDispatchCompute"sv,
                                      "glClearBuffer"sv, "glClearNamedFramebuffer"sv};
constexpr std::array vertex_prefixes = {"glVertex2"sv,      "glVertex3"sv,   "glVertex4"sv,
                                        "glArrayElement"sv, "glEvalCoord"sv, "glEvalPoint"sv};
constexpr std::array read_prefixes = {"glReadPixels"sv,    "glReadnPixels"sv,      "glGetTexImage"sv,
                                      "glGetTexture"sv,    "glGetCompressedTex"sv, "glGetnTexImage"sv,
                                      "glGetnCompressed"sv};
constexpr std::array ask_prefixes = {"glGet"sv, "glIs"sv, "glAre"sv};

template <std::size_t N>
bool starts_with_any(std::string_view name, const std::array<std::string_view, N>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return name.starts_with(p); });
}

CallRole find_role(CallId call) {
  const std::string_view name = call_name(call);
  if (name == "glBegin") return CallRole::begin;
  if (name == "glEnd") return CallRole::end;
  if (name == "glClear") return CallRole::draw;
  if (name == "glFlush" || name == "glFinish") return CallRole::ask;
  if (name.starts_with("glCallList")) return CallRole::call_list;
  if (starts_with_any(name, vertex_prefixes)) return CallRole::vertex;
  if (kind_of(call) == CallKind::vertex) return CallRole::attribute;
  // glDrawBuffer and similar calls set state; glClearBufferData and similar calls write to objects.
  if (name.starts_with("glDrawBuffer") || name.starts_with("glClearBufferData") ||
      name.starts_with("glClearBufferSubData")) {
    return CallRole::state;
  }
  if (starts_with_any(name, draw_prefixes)) return CallRole::draw;
  if (starts_with_any(name, read_prefixes) && name.find("Parameter") == std::string_view::npos)
    return CallRole::read;
  if (starts_with_any(name, ask_prefixes) && !names_something(call)) return CallRole::ask;
  return CallRole::state;
}

std::array<CallRole, call_count> all_roles() {
  std::array<CallRole, call_count> roles{};
  for (std::size_t i = 0; i < call_count; ++i) roles[i] = find_role(CallId(i));
  return roles;
}

}  // namespace

CallRole role_of(CallId call) {
  static const std::array<CallRole, call_count> roles = all_roles();
  return roles[std::size_t(call)];
}

}  // namespace understudy::spu
