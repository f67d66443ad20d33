// SPDX-License-Identifier: Apache-2.0
// Where blending is disabled, or a pixel has several samples, the box of a ray caster is drawn again, clip
// position by clip position, and its fragments take the image's pixels: they cover, hide and are hidden as the
// application's would.
#pragma once

#include <optional>

#include "dispatch/table.h"
#include "spu/volume/geometry/polygon.h"
#include "volume/blending_operator.h"
#include "volume/image.h"
#include "volume/rgba.h"

namespace understudy::spu {

struct GlContext;

/// Holds one texture, one program, one buffer and one vertex array of the context it was made in.
class Replacer {
 public:
  explicit Replacer(const GlContext& context) : context_(context) {}

  /// Draws the triangles of `box` under the application's scissor, masks, depth test and culling. A fragment
  /// outside of `image`, or where that is all zero, becomes `otherwise`. Throws Refusal, and has drawn nothing
  /// then, where the driver does not link the program.
  void replace(const volume::ImageView& image, const volume::Rgba& otherwise, const ObservedPolygons& box);
  /// The same where fragments are blended by `op`, each pixel's at most once; with `alpha`, the framebuffer's
  /// alpha, too. A fragment outside of `image`, or where that is all zero, changes nothing: `op` is none that
  /// this would change (min).
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
  GLint origin_ = -1;  ///< locations of the uniforms that say where the image lies, in pixels
  GLint extent_ = -1;
  GLint otherwise_ = -1;
};

}  // namespace understudy::spu
