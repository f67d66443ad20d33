#include "spu/track/calls.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace understudy::spu {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array vertex_prefixes = {
    "glVertex2"sv,        "glVertex3"sv,         "glVertex4"sv,        "glTexCoord1"sv,     "glTexCoord2"sv,
    "glTexCoord3"sv,      "glTexCoord4"sv,       "glMultiTexCoord"sv,  "glColor3"sv,        "glColor4"sv,
    "glNormal3"sv,        "glSecondaryColor3"sv, "glFogCoordd"sv,      "glFogCoordf"sv,     "glFogCoordh"sv,
    "glEdgeFlag"sv,       "glVertexAttrib1"sv,   "glVertexAttrib2"sv,  "glVertexAttrib3"sv, "glVertexAttrib4"sv,
    "glVertexAttribI1"sv, "glVertexAttribI2"sv,  "glVertexAttribI3"sv, "glVertexAttribI4"sv};
constexpr std::array draw_prefixes = {"glDrawArrays"sv, "glDrawElements"sv, "glDrawRangeElements"sv,
                                      "glMultiDraw"sv,  "glArrayElement"sv, "glRect"sv,
                                      "glEvalMesh"sv,   "glEvalPoint"sv,    "glEvalCoord"sv};
constexpr std::array bound_texture_prefixes = {
    "glTexImage"sv,   "glTexSubImage"sv,        "glCopyTexImage"sv,         "glCopyTexSubImage"sv,
    "glTexStorage"sv, "glCompressedTexImage"sv, "glCompressedTexSubImage"sv};
constexpr std::array unknown_texture_prefixes = {
    "glTextureImage"sv,       "glTextureStorage"sv, "glTextureSubImage"sv,  "glCopyTexture"sv,
    "glCompressedTexture"sv,  "glMultiTexImage"sv,  "glMultiTexSubImage"sv, "glCopyMultiTex"sv,
    "glCompressedMultiTex"sv, "glClearTex"sv,       "glCopyImageSubData"sv, "glTextureView"sv,
    "glEGLImageTargetTex"sv};
constexpr std::array not_compiled_prefixes = {"glGen"sv,
                                              "glDelete"sv,
                                              "glGet"sv,
                                              "glIs"sv,
                                              "glPixelStore"sv,
                                              "glReadPixels"sv,
                                              "glFlush"sv,
                                              "glFinish"sv,
                                              "glRenderMode"sv,
                                              "glFeedbackBuffer"sv,
                                              "glSelectBuffer"sv,
                                              "glVertexPointer"sv,
                                              "glNormalPointer"sv,
                                              "glColorPointer"sv,
                                              "glTexCoordPointer"sv,
                                              "glIndexPointer"sv,
                                              "glEdgeFlagPointer"sv,
                                              "glFogCoordPointer"sv,
                                              "glSecondaryColorPointer"sv,
                                              "glInterleavedArrays"sv,
                                              "glEnableClientState"sv,
                                              "glDisableClientState"sv,
                                              "glClientActiveTexture"sv,
                                              "glPushClientAttrib"sv,
                                              "glPopClientAttrib"sv,
                                              "glBindBuffer"sv,
                                              "glBufferData"sv,
                                              "glBufferSubData"sv,
                                              "glMapBuffer"sv,
                                              "glUnmapBuffer"sv,
                                              "glVertexAttribPointer"sv,
                                              "glEnableVertexAttribArray"sv,
                                              "glDisableVertexAttribArray"sv,
                                              "glBindVertexArray"sv,
                                              "glNewList"sv,
                                              "glEndList"sv,
                                              "glCallList"sv};

template <std::size_t N>
bool starts_with_any(std::string_view name, const std::array<std::string_view, N>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return name.starts_with(p); });
}

CallKind kind_of_name(std::string_view name) {
  if (name == "glBegin" || name == "glEnd") return CallKind::draw;
  if (starts_with_any(name, not_compiled_prefixes)) return CallKind::not_compiled;
  if (name.find("Pointer") == std::string_view::npos && starts_with_any(name, vertex_prefixes))
    return CallKind::vertex;
  if (starts_with_any(name, draw_prefixes)) return CallKind::draw;
  if (starts_with_any(name, bound_texture_prefixes)) return CallKind::bound_texture;
  if (starts_with_any(name, unknown_texture_prefixes)) return CallKind::unknown_texture;
  return CallKind::other;
}

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

int texture_dimensions(CallId call) {
  const std::string_view name = call_name(call);
  for (int d = 1; d <= 3; ++d) {
    const char text[3] = {char('0' + d), 'D', 0};
    if (name.find(text) != std::string_view::npos) return d;
  }
  return 2;
}

}  // namespace understudy::spu
