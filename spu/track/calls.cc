// SPDX-License-Identifier: Apache-2.0
#include "spu/track/calls.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

namespace understudy::spu {
namespace {

constexpr std::string_view vertex_prefixes[] = {
    "glVertex2",        "glVertex3",         "glVertex4",        "glTexCoord1",     "glTexCoord2",
    "glTexCoord3",      "glTexCoord4",       "glMultiTexCoord",  "glColor3",        "glColor4",
    "glNormal3",        "glSecondaryColor3", "glFogCoordd",      "glFogCoordf",     "glFogCoordh",
    "glEdgeFlag",       "glVertexAttrib1",   "glVertexAttrib2",  "glVertexAttrib3", "glVertexAttrib4",
    "glVertexAttribI1", "glVertexAttribI2",  "glVertexAttribI3", "glVertexAttribI4"};
constexpr std::string_view draw_prefixes[] = {"glDrawArrays", "glDrawElements", "glDrawRangeElements",
                                              "glMultiDraw",  "glArrayElement", "glRect",
                                              "glEvalMesh",   "glEvalPoint",    "glEvalCoord"};
constexpr std::string_view bound_texture_prefixes[] = {
    "glTexImage",   "glTexSubImage",        "glCopyTexImage",         "glCopyTexSubImage",
    "glTexStorage", "glCompressedTexImage", "glCompressedTexSubImage"};
constexpr std::string_view unknown_texture_prefixes[] = {
    "glTextureImage",       "glTextureStorage", "glTextureSubImage",  "glCopyTexture",
    "glCompressedTexture",  "glMultiTexImage",  "glMultiTexSubImage", "glCopyMultiTex",
    "glCompressedMultiTex", "glClearTex",       "glCopyImageSubData", "glTextureView",
    "glEGLImageTargetTex"};
constexpr std::string_view not_compiled_prefixes[] = {"glGen",
                                                      "glDelete",
                                                      "glGet",
                                                      "glIs",
                                                      "glPixelStore",
                                                      "glReadPixels",
                                                      "glFlush",
                                                      "glFinish",
                                                      "glRenderMode",
                                                      "glFeedbackBuffer",
                                                      "glSelectBuffer",
                                                      "glVertexPointer",
                                                      "glNormalPointer",
                                                      "glColorPointer",
                                                      "glTexCoordPointer",
                                                      "glIndexPointer",
                                                      "glEdgeFlagPointer",
                                                      "glFogCoordPointer",
                                                      "glSecondaryColorPointer",
                                                      "glInterleavedArrays",
                                                      "glEnableClientState",
                                                      "glDisableClientState",
                                                      "glClientActiveTexture",
                                                      "glPushClientAttrib",
                                                      "glPopClientAttrib",
                                                      "glBindBuffer",
                                                      "glBufferData",
                                                      "glBufferSubData",
                                                      "glMapBuffer",
                                                      "glUnmapBuffer",
                                                      "glVertexAttribPointer",
                                                      "glEnableVertexAttribArray",
                                                      "glDisableVertexAttribArray",
                                                      "glBindVertexArray",
                                                      "glNewList",
                                                      "glEndList",
                                                      "glCallList"};

bool starts_with_any(std::string_view name, std::span<const std::string_view> prefixes) {
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
