// SPDX-License-Identifier: Apache-2.0
// A framebuffer of the application's extent that keeps what is drawn as floats: an 8-bit one rounds each slice,
// and loses fog. With as many samples a pixel as the application's, so that the edges of slices cover as much.
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
  /// All four components of every pixel are `background`; depth is 1 where `depth` does not reach. `samples` 0:
  /// one a pixel.
  FloatFramebuffer(const GlContext& context, int width, int height, int samples,
                   const std::optional<volume::DepthImage>& depth, float background);
  ~FloatFramebuffer();
  FloatFramebuffer(const FloatFramebuffer&) = delete;
  FloatFramebuffer& operator=(const FloatFramebuffer&) = delete;

  /// False where the driver cannot draw into floats.
  bool complete() const { return complete_; }
  /// To draw into.
  GLuint name() const { return framebuffers_[multisampled_ ? 1 : 0]; }
  /// What the constructor does, for the pixels of `rect` alone. Leaves scissor test and bindings as they are.
  void clear(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth, float background);
  /// RGBA of every pixel of `rect`, the mean of its samples.
  std::vector<float> pixels(const volume::Rect& rect) const;

 private:
  void add_samples(int samples);
  void blit(GLuint from, GLuint to, GLbitfield what) const;

  const GlContext& context_;
  int width_;
  int height_;
  bool multisampled_;
  bool complete_ = false;
  std::array<GLuint, 2> textures_{};      ///< colour and depth, one sample a pixel
  std::array<GLuint, 2> buffers_{};       ///< colour and depth, multisampled
  std::array<GLuint, 2> framebuffers_{};  ///< of the textures, of the buffers
};

}  // namespace understudy::spu
