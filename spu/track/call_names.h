// SPDX-License-Identifier: Apache-2.0
// The kind of a command as far as its name determines it. Also evaluated at compile time: tables are filled
// with functions for the commands of one kind, and no other functions are instantiated.
#pragma once

#include <span>
#include <string_view>

#include "spu/track/calls.h"

namespace understudy::spu {
namespace call_names {

inline constexpr std::string_view vertex_prefixes[] = {
    "glVertex2",        "glVertex3",         "glVertex4",        "glTexCoord1",     "glTexCoord2",
    "glTexCoord3",      "glTexCoord4",       "glMultiTexCoord",  "glColor3",        "glColor4",
    "glNormal3",        "glSecondaryColor3", "glFogCoordd",      "glFogCoordf",     "glFogCoordh",
    "glEdgeFlag",       "glVertexAttrib1",   "glVertexAttrib2",  "glVertexAttrib3", "glVertexAttrib4",
    "glVertexAttribI1", "glVertexAttribI2",  "glVertexAttribI3", "glVertexAttribI4"};
inline constexpr std::string_view draw_prefixes[] = {"glDrawArrays", "glDrawElements", "glDrawRangeElements",
                                                     "glMultiDraw",  "glArrayElement", "glRect",
                                                     "glEvalMesh",   "glEvalPoint",    "glEvalCoord"};
inline constexpr std::string_view bound_texture_prefixes[] = {
    "glTexImage",   "glTexSubImage",        "glCopyTexImage",         "glCopyTexSubImage",
    "glTexStorage", "glCompressedTexImage", "glCompressedTexSubImage"};
inline constexpr std::string_view unknown_texture_prefixes[] = {
    "glTextureImage",       "glTextureStorage", "glTextureSubImage",  "glCopyTexture",
    "glCompressedTexture",  "glMultiTexImage",  "glMultiTexSubImage", "glCopyMultiTex",
    "glCompressedMultiTex", "glClearTex",       "glCopyImageSubData", "glTextureView",
    "glEGLImageTargetTex"};
inline constexpr std::string_view not_compiled_prefixes[] = {"glGen",
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

}  // namespace call_names

/// `prefixes` begin with "gl", as all names do; the third letter is compared first, because that is what
/// compilers evaluate fastest.
constexpr bool starts_with_any(std::string_view name, std::span<const std::string_view> prefixes) {
  for (const std::string_view prefix : prefixes)
    if (name[2] == prefix[2] && name.starts_with(prefix)) return true;
  return false;
}

constexpr bool is_draw(std::string_view name) {
  return name == "glBegin" || name == "glEnd" || starts_with_any(name, call_names::draw_prefixes);
}

/// Whether the command changes the contents of a texture.
constexpr bool changes_texture(std::string_view name) {
  return starts_with_any(name, call_names::bound_texture_prefixes) ||
         starts_with_any(name, call_names::unknown_texture_prefixes);
}

constexpr CallKind kind_of_name(std::string_view name) {
  if (starts_with_any(name, call_names::not_compiled_prefixes)) return CallKind::not_compiled;
  if (name.find("Pointer") == std::string_view::npos && starts_with_any(name, call_names::vertex_prefixes))
    return CallKind::vertex;
  if (is_draw(name)) return CallKind::draw;
  if (starts_with_any(name, call_names::bound_texture_prefixes)) return CallKind::bound_texture;
  if (starts_with_any(name, call_names::unknown_texture_prefixes)) return CallKind::unknown_texture;
  return CallKind::other;
}

}  // namespace understudy::spu
