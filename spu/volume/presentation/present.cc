// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/present.h"

#include <algorithm>
#include <cmath>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/presentation/image_blending.h"
#include "spu/volume/presentation/own_program.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {
namespace {

constexpr const char* vertex_source =
    "void main() {\n"
    "  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
    "  gl_Position = vec4(corner, 0.0, 1.0);\n"
    "}\n";
constexpr const char* fragment_source =
    "uniform sampler2D image;\n"
    "uniform ivec2 origin;\n"
    "out vec4 colour;\n"
    "uniform bool first_as_alpha;\n"
    "uniform float shown;\n"
    "void main() {\n"
    "  colour = texelFetch(image, ivec2(gl_FragCoord.xy) - origin, 0);\n"
    "  if (shown >= 0.0) colour.rgb = clamp(colour.rgb - shown, 0.0, 1.0);\n"
    "  if (first_as_alpha) colour.a = colour.r;\n"
    "}\n";

}  // namespace

bool Presenter::prepare() {
  if (program_ != 0) return true;
  const DispatchTable& gl = *context_.gl;
  program_ = link_program(context_, vertex_source, fragment_source);
  if (program_ == 0) return false;
  origin_ = gl.GetUniformLocation(program_, "origin");
  first_as_alpha_ = gl.GetUniformLocation(program_, "first_as_alpha");
  shown_ = gl.GetUniformLocation(program_, "shown");
  gl.GenTextures(1, &texture_);
  gl.GenVertexArrays(1, &vertex_array_);
  return true;
}

void Presenter::show(const volume::ImageView& image) const {
  const DispatchTable& gl = *context_.gl;
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, image.rect.width, image.rect.height, 0, GL_RGBA, GL_FLOAT,
                image.rgba.data());
  gl.Uniform2i(origin_, image.rect.x, image.rect.y);
  // The viewport is the rectangle: exactly its pixels are shaded. Outside of it the image is neutral.
  gl.Viewport(image.rect.x, image.rect.y, image.rect.width, image.rect.height);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Presenter::present_front_to_back(FrontToBack kind, const volume::ImageView& image, const Target& target,
                                      const std::array<GLboolean, 4>& mask) const {
  const DispatchTable& gl = *context_.gl;
  gl.BlendEquation(GL_FUNC_ADD);
  if (kind == FrontToBack::room) {
    gl.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
  } else {
    gl.BlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
  }
  if (target.floating) {
    gl.ColorMask(mask[0], mask[1], mask[2], mask[3]);
    show(image);
    return;
  }
  // A framebuffer that is not float clamps colours before it weights them by the remaining transparency.
  // Colours above 1 are therefore drawn in portions, and alpha with the last of them.
  float brightest = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    brightest = std::max({brightest, image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]});
  constexpr float most_portions = 255;  // 1/255 is the least transparency that 8 bits distinguish from none
  const int portions = int(std::clamp(std::ceil(brightest), 1.0F, most_portions));
  for (int portion = portions; portion-- > 0;) {
    gl.ColorMask(mask[0], mask[1], mask[2], portion == 0 && mask[3]);
    gl.Uniform1f(shown_, float(portion));
    show(image);
  }
}

void Presenter::present_alpha(const AlphaBlending& alpha, const volume::ImageView& image) const {
  const DispatchTable& gl = *context_.gl;
  if (image.rect.empty()) return;
  set_image_blending(gl,
                     alpha.op == volume::Operator::over && alpha.squared ? volume::Operator::add : alpha.op);
  gl.Uniform1i(first_as_alpha_, alpha.squared ? 1 : 0);
  show(image);
}

void Presenter::present(const volume::ImageView& image, const Blending& blending, const Target& target,
                        const volume::ImageView* alpha) {
  const DispatchTable& gl = *context_.gl;
  // The application's scissor and colour mask apply to its slices, and so to the image.
  const GLboolean scissor = gl.IsEnabled(GL_SCISSOR_TEST);
  std::array<GLboolean, 4> mask{};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  SavedState saved(context_);
  if (!prepare()) throw Refusal{"the driver does not link the program that images are drawn with"};
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.UseProgram(program_);
  gl.Uniform1i(first_as_alpha_, 0);
  gl.Uniform1f(shown_, -1);
  gl.BindVertexArray(vertex_array_);
  if (scissor) gl.Enable(GL_SCISSOR_TEST);
  gl.Enable(GL_BLEND);
  const bool apart = alpha != nullptr && blending.alpha_stands_apart();
  if (!image.rect.empty()) {
    gl.ColorMask(mask[0], mask[1], mask[2], mask[3] && !blending.alpha.untouched && !apart);
    if (blending.front_to_back == FrontToBack::no) {
      set_image_blending(gl, blending.op);
      show(image);
    } else {
      present_front_to_back(blending.front_to_back, image, target, mask);
    }
  }
  if (!apart || !mask[3]) return;
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  if (blending.alpha.op == volume::Operator::over && blending.alpha.squared && !image.rect.empty()) {
    // Alpha becomes sum + T * alpha. The blend unit has one source alpha, so the product is drawn first, then
    // the sum.
    gl.BlendFunc(GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
  present_alpha(blending.alpha, *alpha);
}

}  // namespace understudy::spu
