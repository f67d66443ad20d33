// SPDX-License-Identifier: Apache-2.0
// Draws the image where the slices would have been drawn: into the framebuffer that the application has bound.
#pragma once

#include <array>

#include "spu/volume/pipeline/blending.h"
#include "volume/image.h"

namespace understudy::spu {

struct GlContext;

/// Draws images with the blending of the slices that they replace, and with the application's scissor and
/// colour mask. Owns one texture, one program and one vertex array of the context in which it was created.
class Presenter {
 public:
  explicit Presenter(const GlContext& context) : context_(context) {}

  /// Leaves colour and alpha as the slices would have left them. `alpha` is the image of alpha_as_colour() if
  /// `blending.alpha_stands_apart()`. Throws Refusal, with nothing drawn, if the driver does not link the
  /// program.
  void present(const volume::ImageView& image, const Blending& blending, const Target& target,
               const volume::ImageView* alpha);

 private:
  bool prepare();
  void show(const volume::ImageView& image) const;
  void present_front_to_back(FrontToBack kind, const volume::ImageView& image, const Target& target,
                             const std::array<GLboolean, 4>& mask) const;
  void present_alpha(const AlphaBlending& alpha, const volume::ImageView& image) const;

  const GlContext& context_;
  GLuint program_ = 0;
  GLuint texture_ = 0;
  GLuint vertex_array_ = 0;
  GLint origin_ = -1;  ///< location of the uniform that places the rectangle
  GLint first_as_alpha_ = -1;
  GLint shown_ = -1;  ///< how much of the colour has been drawn already; negative: it is drawn in one pass
};

}  // namespace understudy::spu
