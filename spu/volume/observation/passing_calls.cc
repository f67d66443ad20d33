// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/passing_calls.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "spu/track/calls.h"

namespace understudy::spu {
namespace {

/// Runs keep their own blending and depth state; the others only affect later draws.
constexpr auto harmless = std::to_array<GLenum>(
    {GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE, GL_ALPHA_TEST, GL_LIGHTING, GL_FOG, GL_TEXTURE_1D, GL_TEXTURE_2D,
     GL_TEXTURE_3D, GL_TEXTURE_GEN_S, GL_TEXTURE_GEN_T, GL_TEXTURE_GEN_R, GL_TEXTURE_GEN_Q, GL_COLOR_MATERIAL,
     GL_NORMALIZE, GL_FRAGMENT_PROGRAM_ARB});

bool passes(CallId call) {
  if (kind_of(call) == CallKind::vertex) return true;
  constexpr auto families = std::to_array<std::string_view>(
      {// sources of draws
       "glVertexPointer", "glTexCoordPointer", "glColorPointer", "glNormalPointer", "glVertexAttribPointer",
       "glVertexAttribFormat", "glVertexAttribBinding", "glBindVertexBuffer", "glEnableClientState",
       "glDisableClientState", "glClientActiveTexture", "glEnableVertexAttribArray",
       "glDisableVertexAttribArray", "glBindVertexArray", "glBindBuffer", "glBufferData", "glBufferSubData",
       // positions of draws
       "glMatrixMode", "glLoadMatrix", "glLoadIdentity", "glLoadTransposeMatrix", "glMultMatrix",
       "glMultTransposeMatrix", "glPushMatrix", "glPopMatrix", "glTranslate", "glRotate", "glScale",
       "glFrustum", "glOrtho",
       // colours of draws
       "glUseProgram", "glUniform", "glGetUniform"});
  constexpr auto single = std::to_array<std::string_view>(
      {"glActiveTexture", "glActiveTextureARB", "glBindTexture", "glBindTextureEXT", "glBlendFunc",
       "glBlendFuncSeparate", "glBlendEquation", "glBlendEquationSeparate", "glDepthMask", "glDepthFunc",
       // queries that return no pixels
       "glGetError", "glGetIntegerv", "glGetFloatv", "glGetDoublev", "glGetBooleanv", "glGetString",
       "glIsEnabled", "glGetAttribLocation"});
  const std::string_view name = call_name(call);
  return std::any_of(families.begin(), families.end(),
                     [&](std::string_view family) { return name.starts_with(family); }) ||
         std::find(single.begin(), single.end(), name) != single.end();
}

}  // namespace

bool passes_held_runs(CallId call) {
  static const std::vector<bool> answers = [] {
    std::vector<bool> all;
    for (std::size_t i = 0; i < call_count; ++i) all.push_back(passes(CallId(i)));
    return all;
  }();
  return answers[std::size_t(call)];
}

bool passes_held_runs(GLenum capability) {
  return std::find(harmless.begin(), harmless.end(), capability) != harmless.end();
}

}  // namespace understudy::spu
