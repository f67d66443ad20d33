// SPDX-License-Identifier: Apache-2.0
// A float framebuffer of the application's size: an 8-bit one rounds each slice, and loses fog. It has as many
// samples per pixel as the application's, so that the edges of slices cover as much.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "dispatch/table.h"
#include "volume/depth_image.h"

namespace understudy::spu {

struct GlContext;

class FloatFramebuffer {
 public:
  /// Clears all four components of every pixel to `background`, and depth to 1 where there is no `depth`.
  /// `samples` 0: one per pixel.
  FloatFramebuffer(const GlContext& context, int width, int height, int samples,
                   const std::optional<volume::DepthImage>& depth, float background);
  ~FloatFramebuffer();
  FloatFramebuffer(const FloatFramebuffer&) = delete;
  FloatFramebuffer& operator=(const FloatFramebuffer&) = delete;

  /// False if the driver cannot draw into floats.
  bool complete() const { return complete_; }
  /// The framebuffer to draw into.
  GLuint name() const { return framebuffers_[multisampled_ ? 1 : 0]; }
  /// Clears the pixels of `rect` like the constructor. Leaves scissor test and bindings unchanged.
  void clear(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth, float background);
  /// Returns RGBA of every pixel of `rect`, the mean of its samples.
  std::vector<float> pixels(const volume::Rect& rect) const;

 private:
  void add_samples(int samples);
  void blit(GLuint from, GLuint to, GLbitfield what) const;

  const GlContext& context_;
  int width_;
  int height_;
  bool multisampled_;
  bool complete_ = false;
  std::array<GLuint, 2> textures_{};      ///< colour and depth, one sample per pixel
  std::array<GLuint, 2> buffers_{};       ///< colour and depth, multisampled
  std::array<GLuint, 2> framebuffers_{};  ///< with textures_, with buffers_
};

}  // namespace understudy::spu
