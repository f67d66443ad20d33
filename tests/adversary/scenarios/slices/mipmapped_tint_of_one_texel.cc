// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario mipmapped_tint_of_one_texel() {
  return {
      .sentence =
          "A second table of a single texel, filtered by mipmaps as every new texture is, tints the colours. "
          "At frame 10 the texel changes.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("uniform sampler2D tint;", R"(
  colour.rgb *= texture(tint, vec2(value, 0.5)).rgb;)")});
        constexpr std::array<Colour, 2> texels{Colour{255, 200, 120, 255}, Colour{90, 120, 255, 255}};
        upload_table_2d(canvas, 2, {texels[0]});
        canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_LINEAR);
        scene->program.set("tint", 2);
        return [&canvas, scene, texels](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE2);
          if (frame == 10)
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, &texels[1]);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
