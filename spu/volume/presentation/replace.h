// SPDX-License-Identifier: Apache-2.0
// If blending is disabled, or a pixel has several samples, the box of a ray caster is drawn again with its
// captured clip positions, and its fragments take their colours from the image: they cover, hide and are hidden
// as the application's would.
#pragma once

#include <optional>

#include "dispatch/table.h"
#include "spu/volume/geometry/polygon.h"
#include "volume/blending_operator.h"
#include "volume/image.h"
#include "volume/rgba.h"

namespace understudy::spu {

struct GlContext;

/// Owns one texture, one program, one buffer and one vertex array of the context in which it was created.
class Replacer {
 public:
  explicit Replacer(const GlContext& context) : context_(context) {}

  /// Draws the triangles of `box` with the application's scissor, masks, depth test and culling. A fragment
  /// outside of `image`, or where the image is all zero, becomes `otherwise`. Throws Refusal, with nothing
  /// drawn, if the driver does not link the program.
  void replace(const volume::ImageView& image, const volume::Rgba& otherwise, const ObservedPolygons& box);
  /// The same with fragments blended by `op`, at most one per pixel; with `alpha`, into the framebuffer's
  /// alpha, too. A fragment outside of `image`, or where the image is all zero, is zero: it changes nothing
  /// unless `op` is min, which is not allowed.
  void blend(const volume::ImageView& image, volume::Operator op, bool alpha, const ObservedPolygons& box);

 private:
  bool prepare();
  void show(const volume::ImageView& image, const volume::Rgba& otherwise) const;
  void draw(const ObservedPolygons& box) const;
  void draw_once_more(const volume::ImageView& image, const volume::Rgba& otherwise,
                      const ObservedPolygons& box, std::optional<volume::Operator> blended, bool alpha);

  const GlContext& context_;
  GLuint program_ = 0;
  GLuint texture_ = 0;
  GLuint vertices_ = 0;
  GLuint vertex_array_ = 0;
  GLint origin_ = -1;  ///< locations of the uniforms that place the image, in pixels
  GLint extent_ = -1;
  GLint otherwise_ = -1;
};

}  // namespace understudy::spu
