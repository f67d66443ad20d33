// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/context/saved_state.h"

#include <algorithm>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

constexpr std::array<GLenum, 16> pixel_store_names = {
    GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST,     GL_PACK_ROW_LENGTH,    GL_PACK_IMAGE_HEIGHT,
    GL_PACK_SKIP_ROWS,    GL_PACK_SKIP_PIXELS,   GL_PACK_SKIP_IMAGES,   GL_PACK_ALIGNMENT,
    GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT,
    GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_ALIGNMENT};

constexpr std::array<GLenum, 8> switched_off = {GL_BLEND,        GL_DEPTH_TEST,        GL_STENCIL_TEST,
                                                GL_SCISSOR_TEST, GL_CULL_FACE,         GL_MULTISAMPLE,
                                                GL_DITHER,       GL_RASTERIZER_DISCARD};

}  // namespace

SavedState::SavedState(const GlContext& context)
    : gl_(*context.gl), core_(context.core), version_(context.version) {
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_framebuffer_);
  gl_.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_framebuffer_);
  gl_.GetIntegerv(GL_CURRENT_PROGRAM, &program_);
  gl_.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
  gl_.GetIntegerv(GL_ARRAY_BUFFER_BINDING, &array_buffer_);
  gl_.GetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &pack_buffer_);
  gl_.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &unpack_buffer_);
  gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active_texture_);
  gl_.GetIntegerv(GL_VIEWPORT, viewport_.data());
  gl_.GetIntegerv(GL_POLYGON_MODE, polygon_mode_.data());
  gl_.GetBooleanv(GL_COLOR_WRITEMASK, color_mask_.data());
  gl_.GetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  gl_.GetIntegerv(GL_BLEND_SRC_RGB, &blend_factors_[0]);
  gl_.GetIntegerv(GL_BLEND_DST_RGB, &blend_factors_[1]);
  gl_.GetIntegerv(GL_BLEND_SRC_ALPHA, &blend_factors_[2]);
  gl_.GetIntegerv(GL_BLEND_DST_ALPHA, &blend_factors_[3]);
  gl_.GetIntegerv(GL_BLEND_EQUATION_RGB, &blend_equations_[0]);
  gl_.GetIntegerv(GL_BLEND_EQUATION_ALPHA, &blend_equations_[1]);

  GLint clip_planes = 0;
  gl_.GetIntegerv(GL_MAX_CLIP_DISTANCES, &clip_planes);
  // No exception may be thrown after the first is disabled: the destructor would not run and enable it again.
  capabilities_.reserve(switched_off.size() + std::size_t(std::max(clip_planes, 0)) + 1);
  const auto switch_off = [this](GLenum name) {
    const GLboolean enabled = gl_.IsEnabled(name);
    capabilities_.push_back({name, enabled});
    if (enabled) gl_.Disable(name);
  };
  for (const GLenum name : switched_off) switch_off(name);
  for (GLint i = 0; i < clip_planes; ++i) switch_off(GLenum(GL_CLIP_DISTANCE0 + i));
  if (!core_) switch_off(GL_ALPHA_TEST);

  for (std::size_t i = 0; i < pixel_store_names.size(); ++i) {
    gl_.GetIntegerv(pixel_store_names[i], &pixel_store_[i]);
    const bool alignment =
        pixel_store_names[i] == GL_PACK_ALIGNMENT || pixel_store_names[i] == GL_UNPACK_ALIGNMENT;
    gl_.PixelStorei(pixel_store_names[i], alignment ? 1 : 0);
  }
  if (!core_) {
    gl_.GetFloatv(GL_DEPTH_SCALE, &depth_scale_);
    gl_.GetFloatv(GL_DEPTH_BIAS, &depth_bias_);
    gl_.PixelTransferf(GL_DEPTH_SCALE, 1);
    gl_.PixelTransferf(GL_DEPTH_BIAS, 0);
  }
  gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthMask(GL_FALSE);
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

bool SavedState::was_enabled(GLenum capability) const {
  return std::any_of(capabilities_.begin(), capabilities_.end(),
                     [&](const Capability& c) { return c.name == capability && c.enabled; });
}

void SavedState::borrow_texture(GLenum target, int unit) {
  borrowed_.reserve(borrowed_.size() + 1);
  BorrowedTexture borrowed{target, unit, 0, 0};
  gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
  const GLenum binding = target == GL_TEXTURE_3D   ? GL_TEXTURE_BINDING_3D
                         : target == GL_TEXTURE_2D ? GL_TEXTURE_BINDING_2D
                                                   : GL_TEXTURE_BINDING_1D;
  gl_.GetIntegerv(binding, &borrowed.texture);
  if (version_ >= 330) {
    gl_.GetIntegerv(GL_SAMPLER_BINDING, &borrowed.sampler);
    gl_.BindSampler(GLuint(unit), 0);
  }
  borrowed_.push_back(borrowed);
}

void SavedState::give_back_texture(GLenum target, int unit) {
  const auto borrowed = std::find_if(borrowed_.begin(), borrowed_.end(), [&](const BorrowedTexture& texture) {
    return texture.target == target && texture.unit == unit;
  });
  if (borrowed == borrowed_.end()) return;
  bind_again(*borrowed);
  borrowed_.erase(borrowed);
}

void SavedState::bind_again(const BorrowedTexture& borrowed) const {
  gl_.ActiveTexture(GLenum(GL_TEXTURE0 + borrowed.unit));
  gl_.BindTexture(borrowed.target, GLuint(borrowed.texture));
  if (version_ >= 330) gl_.BindSampler(GLuint(borrowed.unit), GLuint(borrowed.sampler));
}

SavedState::~SavedState() {
  for (auto it = borrowed_.rbegin(); it != borrowed_.rend(); ++it) bind_again(*it);
  gl_.ActiveTexture(GLenum(active_texture_));
  gl_.UseProgram(GLuint(program_));
  gl_.BindVertexArray(GLuint(vertex_array_));
  gl_.BindBuffer(GL_ARRAY_BUFFER, GLuint(array_buffer_));
  gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(pack_buffer_));
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, GLuint(unpack_buffer_));
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(draw_framebuffer_));
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(read_framebuffer_));
  gl_.Viewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  if (core_ || polygon_mode_[0] == polygon_mode_[1]) {
    gl_.PolygonMode(GL_FRONT_AND_BACK, GLenum(polygon_mode_[0]));
  } else {
    gl_.PolygonMode(GL_FRONT, GLenum(polygon_mode_[0]));
    gl_.PolygonMode(GL_BACK, GLenum(polygon_mode_[1]));
  }
  gl_.ColorMask(color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
  gl_.DepthMask(depth_mask_);
  gl_.BlendFuncSeparate(GLenum(blend_factors_[0]), GLenum(blend_factors_[1]), GLenum(blend_factors_[2]),
                        GLenum(blend_factors_[3]));
  gl_.BlendEquationSeparate(GLenum(blend_equations_[0]), GLenum(blend_equations_[1]));
  for (std::size_t i = 0; i < pixel_store_names.size(); ++i)
    gl_.PixelStorei(pixel_store_names[i], pixel_store_[i]);
  if (!core_) {
    gl_.PixelTransferf(GL_DEPTH_SCALE, depth_scale_);
    gl_.PixelTransferf(GL_DEPTH_BIAS, depth_bias_);
  }
  for (const Capability& capability : capabilities_) {
    if (capability.enabled) {
      gl_.Enable(capability.name);
    } else {
      gl_.Disable(capability.name);
    }
  }
}

}  // namespace understudy::spu
