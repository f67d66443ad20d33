// The picture goes back where the slices would have been drawn: into whatever framebuffer the application has
// bound.
#pragma once

#include "spu/volume/context.h"
#include "spu/volume/pipeline.h"
#include "volume/image.h"

namespace understudy::spu {

/// Draws premultiplied images under `ONE, 1 - SRC_ALPHA` with the application's scissor and colour mask. Holds
/// one texture, one program and one vertex array of the context it was made in.
class Presenter {
 public:
  explicit Presenter(const GlContext& context) : context_(context) {}

  /// Colour as the slices would have left it, and alpha as `result` says. The squared sum, where that is the
  /// result, is the first channel of `alpha`, over the same rectangle as `image`.
  void present(const volume::ImageView& image, AlphaResult result, const volume::ImageView* alpha);

 private:
  bool prepare();
  void draw(const volume::ImageView& image) const;

  const GlContext& context_;
  GLuint program_ = 0;
  GLuint texture_ = 0;
  GLuint vertex_array_ = 0;
  GLint origin_ = -1;  ///< location of the uniform that places the rectangle
  GLint first_as_alpha_ = -1;
};

}  // namespace understudy::spu
