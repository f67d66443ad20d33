// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/context/indexed_state.h"

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

constexpr std::array<GLenum, 4> factor_names{GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA,
                                             GL_BLEND_DST_ALPHA};
constexpr std::array<GLenum, 2> equation_names{GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};

void enable(const DispatchTable& gl, GLenum capability, GLuint index, GLboolean enabled) {
  if (enabled)
    gl.Enablei(capability, index);
  else
    gl.Disablei(capability, index);
}

}  // namespace

IndexedState::IndexedState(const GlContext& context) : gl_(*context.gl), version_(context.version) {
  GLint draw_buffers = 0;
  GLint viewports = 0;
  if (version_ >= 300) gl_.GetIntegerv(GL_MAX_DRAW_BUFFERS, &draw_buffers);
  if (version_ >= 410) gl_.GetIntegerv(GL_MAX_VIEWPORTS, &viewports);
  draw_buffers_.resize(std::size_t(draw_buffers));
  viewports_.resize(std::size_t(viewports));
  for (GLuint i = 0; i < draw_buffers_.size(); ++i) {
    DrawBuffer& buffer = draw_buffers_[i];
    gl_.GetBooleani_v(GL_COLOR_WRITEMASK, i, buffer.mask.data());
    buffer.blends = gl_.IsEnabledi(GL_BLEND, i);
    if (version_ < 400) continue;
    for (std::size_t k = 0; k < factor_names.size(); ++k)
      gl_.GetIntegeri_v(factor_names[k], i, &buffer.factors[k]);
    for (std::size_t k = 0; k < equation_names.size(); ++k)
      gl_.GetIntegeri_v(equation_names[k], i, &buffer.equations[k]);
  }
  for (GLuint i = 0; i < viewports_.size(); ++i) {
    Viewport& viewport = viewports_[i];
    gl_.GetFloati_v(GL_VIEWPORT, i, viewport.place.data());
    gl_.GetIntegeri_v(GL_SCISSOR_BOX, i, viewport.scissor.data());
    viewport.scissors = gl_.IsEnabledi(GL_SCISSOR_TEST, i);
  }
}

IndexedState::~IndexedState() {
  for (GLuint i = 0; i < draw_buffers_.size(); ++i) {
    const DrawBuffer& buffer = draw_buffers_[i];
    gl_.ColorMaski(i, buffer.mask[0], buffer.mask[1], buffer.mask[2], buffer.mask[3]);
    enable(gl_, GL_BLEND, i, buffer.blends);
    if (version_ < 400) continue;
    gl_.BlendFuncSeparatei(i, GLenum(buffer.factors[0]), GLenum(buffer.factors[1]), GLenum(buffer.factors[2]),
                           GLenum(buffer.factors[3]));
    gl_.BlendEquationSeparatei(i, GLenum(buffer.equations[0]), GLenum(buffer.equations[1]));
  }
  for (GLuint i = 0; i < viewports_.size(); ++i) {
    const Viewport& viewport = viewports_[i];
    gl_.ViewportIndexedfv(i, viewport.place.data());
    gl_.ScissorIndexedv(i, viewport.scissor.data());
    enable(gl_, GL_SCISSOR_TEST, i, viewport.scissors);
  }
}

}  // namespace understudy::spu
