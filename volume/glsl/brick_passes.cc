// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/brick_passes.h"

#include <algorithm>

namespace understudy::volume::glsl {

namespace {

void bind_texture(const Functions& gl, Unit unit, GLenum target, GLuint texture) {
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + GLint(unit)));
  gl.BindTexture(target, texture);
}

}  // namespace

BrickPasses::BrickPasses(Device& device, const BrickStore& store, int brick_cells)
    : device_(device), atlas_(device, store, brick_cells), states_{State(device.gl()), State(device.gl())} {
  for (State& state : states_) device.gl().GenFramebuffers(1, &state.framebuffer);
}

BrickPasses::~BrickPasses() {
  for (const State& state : states_) device_.gl().DeleteFramebuffers(1, &state.framebuffer);
}

void BrickPasses::resize(int width, int height) {
  if (width <= made_width_ && height <= made_height_) return;
  const Functions& gl = device_.gl();
  made_width_ = std::max(made_width_, width);
  made_height_ = std::max(made_height_, height);
  for (State& state : states_) {
    for (const Texture* texture : {&state.sums, &state.progress}) {
      bind_texture(gl, Unit::sums, GL_TEXTURE_2D, texture->name());
      gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, made_width_, made_height_, 0, GL_RGBA, GL_FLOAT, nullptr);
      gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, state.framebuffer);
    gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, state.sums.name(), 0);
    gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, state.progress.name(), 0);
    const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl.DrawBuffers(2, both);
    device_.check("making textures for an image");
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) continue;
    made_width_ = made_height_ = 0;
    throw NotSupported("this OpenGL does not draw into float textures");
  }
}

std::size_t BrickPasses::first_wanted(std::vector<std::size_t>& order) const {
  std::vector<bool> wanted(atlas_.grid().bricks());
  for (const std::array<float, 4>& ray : progress_)
    if (ray[2] > 0 && std::size_t(ray[2]) <= wanted.size()) wanted[std::size_t(ray[2]) - 1] = true;
  std::size_t first = order.size();
  for (std::size_t i = order.size(); i-- > 0;)
    if (wanted[order[i]]) {
      first = i;
      wanted[order[i]] = false;
    }
  for (std::size_t brick = 0; brick < wanted.size(); ++brick)
    if (wanted[brick]) order.push_back(brick);
  return first;
}

void BrickPasses::draw(const MarchProgram& program, int width, int height, std::vector<std::size_t> order) {
  const Functions& gl = device_.gl();
  resize(width, height);
  width_ = width;
  height_ = height;
  progress_.resize(std::size_t(width) * std::size_t(height));
  gl.Viewport(0, 0, width, height);
  double walked = -1;
  std::size_t from = 0;
  for (passes_ = 0; passes_ == 0 || from < order.size(); ++passes_) {
    const std::size_t count = std::min(atlas_.slots(), order.size() - from);
    // make_resident() binds textures on the active unit: use the field's, which is bound again next.
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + GLint(Unit::field)));
    atlas_.make_resident(std::span(order).subspan(from, count));
    const State &before = states_[std::size_t(passes_ + 1) % 2], &after = states_[std::size_t(passes_) % 2];
    bind_texture(gl, Unit::field, GL_TEXTURE_3D, atlas_.texels());
    bind_texture(gl, Unit::pages, GL_TEXTURE_3D, atlas_.pages());
    bind_texture(gl, Unit::sums, GL_TEXTURE_2D, before.sums.name());
    bind_texture(gl, Unit::progress, GL_TEXTURE_2D, before.progress.name());
    gl.Uniform1i(program.passes_before, passes_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, after.framebuffer);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, progress_.data());
    device_.check("drawing the volume by bricks");
    double reached = 0;
    for (const std::array<float, 4>& ray : progress_) reached += double(ray[0]);
    from = first_wanted(order);
    if (from < order.size() && !(reached > walked))
      throw NotSupported("this OpenGL does not find the bricks that it was given");
    walked = reached;
  }
}

void BrickPasses::read_image(int row_pixels, float* to) const {
  const Functions& gl = device_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, states_[std::size_t(passes_ - 1) % 2].framebuffer);
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, row_pixels);
  gl.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, to);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, 0);
}

}  // namespace understudy::volume::glsl
