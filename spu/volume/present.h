// The picture goes back where the slices would have been drawn: into whatever framebuffer the application has bound.
#pragma once

#include "spu/volume/context.h"
#include "volume/image.h"

namespace understudy::spu {

/// Draws premultiplied images under `ONE, 1 - SRC_ALPHA` with the application's scissor and colour mask. Holds one
/// texture, one program and one vertex array of the context it was made in.
class Presenter {
 public:
  explicit Presenter(const GlContext& context) : context_(context) {}

  void present(const volume::ImageView& image);

 private:
  bool prepare();

  const GlContext& context_;
  GLuint program_ = 0;
  GLuint texture_ = 0;
  GLuint vertex_array_ = 0;
  GLint origin_ = -1;  ///< location of the uniform that places the rectangle
};

}  // namespace understudy::spu
