// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/native_image.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "volume/request.h"

namespace understudy::spu {
namespace {

/// In its scope, alpha is blended like the application's colour, as in the nodes' images.
class ColourBlending {
 public:
  ColourBlending(const DispatchTable& gl, const Blending& blending) : gl_(gl) {
    gl_.GetIntegerv(GL_BLEND_SRC_RGB, &factors_[0]);
    gl_.GetIntegerv(GL_BLEND_DST_RGB, &factors_[1]);
    gl_.GetIntegerv(GL_BLEND_SRC_ALPHA, &factors_[2]);
    gl_.GetIntegerv(GL_BLEND_DST_ALPHA, &factors_[3]);
    gl_.GetIntegerv(GL_BLEND_EQUATION_RGB, &equations_[0]);
    gl_.GetIntegerv(GL_BLEND_EQUATION_ALPHA, &equations_[1]);
    gl_.GetBooleanv(GL_COLOR_WRITEMASK, written_.data());
    // Applications may leave a window's alpha unwritten; an image has alpha.
    gl_.ColorMask(written_[0], written_[1], written_[2], GL_TRUE);
    if (blending.replaces) return;
    gl_.BlendEquation(GLenum(equations_[0]));
    if (blending.front_to_back != FrontToBack::no) {
      gl_.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    } else {
      gl_.BlendFuncSeparate(GLenum(factors_[0]), GLenum(factors_[1]), GL_ONE,
                            blending.op == volume::Operator::add ? GL_ONE : GL_ONE_MINUS_SRC_ALPHA);
    }
  }
  ~ColourBlending() {
    gl_.BlendEquationSeparate(GLenum(equations_[0]), GLenum(equations_[1]));
    gl_.BlendFuncSeparate(GLenum(factors_[0]), GLenum(factors_[1]), GLenum(factors_[2]), GLenum(factors_[3]));
    gl_.ColorMask(written_[0], written_[1], written_[2], written_[3]);
  }
  ColourBlending(const ColourBlending&) = delete;
  ColourBlending& operator=(const ColourBlending&) = delete;

 private:
  const DispatchTable& gl_;
  std::array<GLint, 4> factors_{};
  std::array<GLint, 2> equations_{};
  std::array<GLboolean, 4> written_{};
};

/// In its scope, fragments are clamped to [0,1] before they are blended into floats, as they are in the
/// application's framebuffer unless that has floats. Only compatibility profiles can.
class ClampedFragments {
 public:
  ClampedFragments(const GlContext& context, const Target& target)
      : gl_(*context.gl), clamps_(!context.core && !target.floating) {
    if (!clamps_) return;
    gl_.GetIntegerv(GL_CLAMP_FRAGMENT_COLOR, &before_);
    gl_.ClampColor(GL_CLAMP_FRAGMENT_COLOR, GL_TRUE);
  }
  ~ClampedFragments() {
    if (clamps_) gl_.ClampColor(GL_CLAMP_FRAGMENT_COLOR, GLenum(before_));
  }
  ClampedFragments(const ClampedFragments&) = delete;
  ClampedFragments& operator=(const ClampedFragments&) = delete;

 private:
  const DispatchTable& gl_;
  bool clamps_;
  GLint before_ = 0;
};

/// Narrows the application's scissor to `rect` in its scope.
class NarrowedScissor {
 public:
  NarrowedScissor(const DispatchTable& gl, const volume::Rect& rect)
      : gl_(gl), enabled_(gl.IsEnabled(GL_SCISSOR_TEST)) {
    gl_.GetIntegerv(GL_SCISSOR_BOX, box_.data());
    const volume::Rect own{box_[0], box_[1], box_[2], box_[3]};
    const volume::Rect both = enabled_ ? intersection(own, rect) : rect;
    gl_.Enable(GL_SCISSOR_TEST);
    gl_.Scissor(both.x, both.y, both.width, both.height);
  }
  ~NarrowedScissor() {
    if (!enabled_) gl_.Disable(GL_SCISSOR_TEST);
    gl_.Scissor(box_[0], box_[1], box_[2], box_[3]);
  }
  NarrowedScissor(const NarrowedScissor&) = delete;
  NarrowedScissor& operator=(const NarrowedScissor&) = delete;

 private:
  const DispatchTable& gl_;
  GLboolean enabled_;
  std::array<GLint, 4> box_{};
};

/// Waits until the device has drawn everything. Not by glFinish where a fence can do it: glFinish ends a frame
/// of OSMesa.
void wait_for_device(const GlContext& context) {
  const DispatchTable& gl = *context.gl;
  if (context.version < 320) return gl.Finish();
  GLsync const fence = gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, ~GLuint64(0));
  gl.DeleteSync(fence);
}

}  // namespace

NativeDrawing::NativeDrawing(const GlContext& context, const Pipeline& pipeline,
                             const volume::RenderRequest& request)
    : context_(context), background_(pipeline.blending.op == volume::Operator::min ? 1.0F : 0.0F) {
  // Only the part of the viewport that lies in the application's framebuffer is ever read.
  const int width = request.viewport.x + request.viewport.width;
  const int height = request.viewport.y + request.viewport.height;
  GLint longest = 0;
  context.gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &longest);
  if (width < 1 || height < 1 || width > longest || height > longest) return;
  framebuffer_.emplace(context, width, height, pipeline.target.samples, request.depth, background_);
}

void NativeDrawing::draw(const Run& run) {
  const DispatchTable& gl = *context_.gl;
  GLint bound = 0;
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_->name());
  {
    const ColourBlending blending(gl, run.pipeline().blending);
    const ClampedFragments clamped(context_, run.pipeline().target);
    run.replay(gl);
  }
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound));
}

void NativeDrawing::add(const Run& run) {
  if (complete()) draw(run);
}

void NativeDrawing::compile(const Run& run, const volume::Rect& window,
                            const std::optional<volume::DepthImage>& depth) {
  const volume::Rect pixel{window.x + window.width / 2, window.y + window.height / 2, 1, 1};
  clear(pixel, depth);
  add_within(run, pixel);
  clear(pixel, depth);
}

double NativeDrawing::add_timed(const Run& run) {
  wait_for_device(context_);
  const auto start = std::chrono::steady_clock::now();
  add(run);
  wait_for_device(context_);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void NativeDrawing::clear(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth) {
  if (complete()) framebuffer_->clear(rect, depth, background_);
}

void NativeDrawing::add_within(const Run& run, const volume::Rect& rect) {
  const NarrowedScissor scissor(*context_.gl, rect);
  add(run);
}

NativeImage NativeDrawing::image(const volume::Rect& rect) const {
  const DispatchTable& gl = *context_.gl;
  std::array<GLint, 2> bound{};
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound[0]);
  gl.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound[1]);
  NativeImage drawn{rect, framebuffer_->pixels(rect)};
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound[0]));
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound[1]));
  return drawn;
}

std::optional<NativeImage> native_image(const GlContext& context, const Run& run,
                                        const volume::RenderRequest& request, const volume::Rect& rect) {
  if (rect.empty()) return std::nullopt;
  NativeDrawing drawing(context, run.pipeline(), request);
  drawing.add(run);
  if (!drawing.complete()) return std::nullopt;
  return drawing.image(rect);
}

}  // namespace understudy::spu
