// SPDX-License-Identifier: Apache-2.0
#include "spu/track/state_topics.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "spu/track/calls.h"

namespace understudy::spu {
namespace {

struct Rule {
  std::string_view name;  ///< a trailing * matches any text
  StateTopics topics;
};

/// The longest matching pattern applies. Commands without one change everything: deletions (which unbind),
/// popping attributes, and commands of rare extensions.
constexpr Rule rules[] = {
    {"glGet*", topic::nothing},
    {"glIs*", topic::nothing},
    {"glAre*", topic::nothing},
    {"glCheck*", topic::nothing},
    {"glGen*", topic::nothing},
    {"glUniform*", topic::nothing},
    {"glProgramUniform*", topic::nothing},
    {"glShaderSource*", topic::nothing},
    {"glCompileShader*", topic::nothing},
    {"glAttachShader", topic::nothing},
    {"glDetachShader", topic::nothing},
    {"glBindAttribLocation*", topic::nothing},
    {"glBindFragDataLocation*", topic::nothing},
    {"glTexImage*", topic::nothing},
    {"glTexSubImage*", topic::nothing},
    {"glTexStorage*", topic::nothing},
    {"glTexParameter*", topic::nothing},
    {"glTextureImage*", topic::nothing},
    {"glTextureSubImage*", topic::nothing},
    {"glTextureStorage*", topic::nothing},
    {"glTextureParameter*", topic::nothing},
    {"glTexEnv*", topic::nothing},
    {"glTexGen*", topic::nothing},
    {"glCopyTexImage*", topic::nothing},
    {"glCopyTexSubImage*", topic::nothing},
    {"glCompressedTexImage*", topic::nothing},
    {"glCompressedTexSubImage*", topic::nothing},
    {"glSamplerParameter*", topic::nothing},
    {"glBufferData*", topic::nothing},
    {"glBufferSubData*", topic::nothing},
    {"glBufferStorage*", topic::nothing},
    {"glNamedBuffer*", topic::nothing},
    {"glMapBuffer*", topic::nothing},
    {"glMapNamedBuffer*", topic::nothing},
    {"glUnmapBuffer*", topic::nothing},
    {"glUnmapNamedBuffer*", topic::nothing},
    {"glFlush*", topic::nothing},
    {"glFinish", topic::nothing},
    {"glClear", topic::nothing},
    {"glClearBuffer*", topic::nothing},
    {"glClearNamed*", topic::nothing},
    {"glClearTex*", topic::nothing},
    {"glReadPixels", topic::nothing},
    {"glReadnPixels*", topic::nothing},
    {"glDrawPixels", topic::nothing},
    {"glCopyPixels", topic::nothing},
    {"glBitmap", topic::nothing},
    {"glAccum", topic::nothing},
    {"glBlitFramebuffer*", topic::nothing},
    {"glFenceSync", topic::nothing},
    {"glWaitSync", topic::nothing},
    {"glClientWaitSync", topic::nothing},
    {"glDeleteSync", topic::nothing},
    {"glQueryCounter", topic::nothing},
    {"glBeginQuery*", topic::nothing},
    {"glEndQuery*", topic::nothing},
    {"glPushMatrix", topic::nothing},
    {"glPushAttrib", topic::nothing},
    {"glPushClientAttrib", topic::nothing},
    {"glRasterPos*", topic::nothing},
    {"glWindowPos*", topic::nothing},
    {"glNewList", topic::nothing},
    {"glEndList", topic::nothing},
    // These set values that glGet does not return.
    {"glLight*", topic::nothing},
    {"glMaterial*", topic::nothing},
    {"glClipPlane*", topic::nothing},

    {"glBegin", topic::current},
    {"glEnd", topic::current},
    {"glFogCoord*", topic::current},
    {"glIndexd*", topic::current},
    {"glIndexf*", topic::current},
    {"glIndexi*", topic::current},
    {"glIndexs*", topic::current},
    {"glIndexub*", topic::current},

    {"glMatrixMode", topic::matrix},
    {"glLoadIdentity", topic::matrix},
    {"glLoadMatrix*", topic::matrix},
    {"glLoadTransposeMatrix*", topic::matrix},
    {"glMultMatrix*", topic::matrix},
    {"glMultTransposeMatrix*", topic::matrix},
    {"glPopMatrix", topic::matrix},
    {"glRotate*", topic::matrix},
    {"glScaled", topic::matrix},
    {"glScalef", topic::matrix},
    {"glTranslate*", topic::matrix},
    {"glFrustum*", topic::matrix},
    {"glOrtho*", topic::matrix},

    {"glActiveTexture*", topic::unit},
    {"glClientActiveTexture*", topic::unit},

    // In compatibility profiles these also affect client arrays.
    {"glEnable", topic::capability | topic::arrays},
    {"glDisable", topic::capability | topic::arrays},
    {"glEnablei", topic::capability | topic::arrays},
    {"glDisablei", topic::capability | topic::arrays},
    {"glEnableClientState*", topic::arrays},
    {"glDisableClientState*", topic::arrays},
    {"glEnableVertexAttribArray*", topic::arrays},
    {"glDisableVertexAttribArray*", topic::arrays},
    {"glBindVertexArray", topic::arrays},
    {"glVertexPointer", topic::arrays},
    {"glNormalPointer", topic::arrays},
    {"glColorPointer", topic::arrays},
    {"glTexCoordPointer", topic::arrays},
    {"glVertexAttribPointer*", topic::arrays},
    {"glVertexAttribIPointer*", topic::arrays},
    {"glVertexAttribDivisor*", topic::arrays},

    {"glBindBuffer", topic::buffer | topic::arrays},
    {"glBindBufferARB", topic::buffer | topic::arrays},
    {"glBindBufferBase", topic::buffer},
    {"glBindBufferRange", topic::buffer},
    {"glBindBuffersBase", topic::buffer},
    {"glBindBuffersRange", topic::buffer},

    {"glBindTexture*", topic::texture},
    {"glBindSampler*", topic::texture},

    {"glBindFramebuffer*", topic::framebuffer},
    {"glBindRenderbuffer*", topic::framebuffer},
    {"glRenderbufferStorage*", topic::framebuffer},
    {"glFramebufferTexture*", topic::framebuffer},
    {"glFramebufferRenderbuffer*", topic::framebuffer},
    {"glDrawBuffer*", topic::framebuffer},
    {"glReadBuffer*", topic::framebuffer},

    {"glUseProgram", topic::program},
    {"glUseProgramObjectARB", topic::program},
    {"glBindProgramPipeline", topic::program},

    {"glBlendFunc*", topic::blending},
    {"glBlendEquation*", topic::blending},
    {"glBlendColor*", topic::blending},
    {"glLogicOp", topic::blending},
    {"glColorMask*", topic::blending},
    {"glAlphaFunc", topic::blending},

    {"glDepthFunc", topic::depth},
    {"glDepthMask", topic::depth},
    {"glStencil*", topic::stencil},

    {"glPointSize", topic::raster},
    {"glPointParameter*", topic::raster},
    {"glLineWidth", topic::raster},
    {"glLineStipple", topic::raster},
    {"glPolygonMode", topic::raster},
    {"glPolygonOffset*", topic::raster},
    {"glPolygonStipple", topic::nothing},
    {"glCullFace", topic::raster},
    {"glFrontFace", topic::raster},
    {"glShadeModel", topic::raster},
    {"glProvokingVertex*", topic::raster},
    {"glSampleCoverage*", topic::raster},
    {"glSampleMask*", topic::raster},
    {"glMinSampleShading*", topic::raster},
    {"glClampColor*", topic::raster},
    {"glPatchParameter*", topic::raster},
    {"glPrimitiveRestartIndex*", topic::raster},

    {"glViewport*", topic::viewport},
    {"glScissor*", topic::viewport},
    {"glDepthRange*", topic::viewport},
    {"glClipControl*", topic::viewport},

    {"glPixelStore*", topic::pixels},
    {"glPixelTransfer*", topic::pixels},
    {"glPixelZoom", topic::pixels},

    {"glFog*", topic::light},
    {"glLightModel*", topic::light},
    {"glColorMaterial", topic::light},

    {"glClearColor", topic::clearing},
    {"glClearDepth*", topic::clearing},
    {"glClearStencil", topic::clearing},
    {"glClearAccum", topic::clearing},
    {"glClearIndex", topic::clearing},
    {"glIndexMask", topic::clearing},

    {"glHint", topic::hints},
    {"glListBase", topic::lists},
};

bool fits(std::string_view pattern, std::string_view name) {
  if (!pattern.ends_with('*')) return pattern == name;
  return name.starts_with(pattern.substr(0, pattern.size() - 1));
}

StateTopics topics_of_name(CallId call) {
  // Draws may change the current attributes from the arrays.
  const CallKind kind = kind_of(call);
  if (kind == CallKind::vertex || kind == CallKind::draw) return topic::current;
  const Rule* best = nullptr;
  for (const Rule& rule : rules) {
    if (!fits(rule.name, call_name(call))) continue;
    if (best == nullptr || rule.name.size() > best->name.size()) best = &rule;
  }
  return best == nullptr ? topic::everything : best->topics;
}

}  // namespace

StateTopics topics_changed_by(CallId call) {
  static const std::array<StateTopics, call_count> topics = [] {
    std::array<StateTopics, call_count> all{};
    for (std::size_t i = 0; i < call_count; ++i) all[i] = topics_of_name(CallId(i));
    return all;
  }();
  return topics[std::size_t(call)];
}

StateTopics topics_of(const StateRow& row) {
  StateTopics topics = topics_changed_by(row.set);
  if (row.selector != Selector::none) topics |= topic::unit;
  return topics;
}

}  // namespace understudy::spu
