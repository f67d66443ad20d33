// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario mipmapped_table_striped() {
  return {
      .sentence =
          "A 1-D table with mipmaps is a ramp of greys, which looks alike in all levels. At frame 10 it gets "
          "stripes of eight texels, which its upper levels average.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("uniform sampler1D levels;", R"(
  colour = texture(levels, value);)")});
        std::vector<Colour> ramp(256);
        std::vector<Colour> stripes(256);
        for (int i = 0; i < 256; ++i) {
          const auto grey = static_cast<std::uint8_t>(i);
          ramp[i] = {grey, grey, grey, 20};
          stripes[i] = i / 8 % 2 == 0 ? Colour{255, 40, 40, 60} : Colour{40, 40, 255, 2};
        }
        upload_table_1d(canvas, 2, ramp);
        canvas.gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        canvas.gl.GenerateMipmap(GL_TEXTURE_1D);
        scene->program.set("levels", 2);
        return [&canvas, scene, stripes](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE2);
          if (frame == 10) {
            canvas.gl.TexSubImage1D(GL_TEXTURE_1D, 0, 0, 256, GL_RGBA, GL_UNSIGNED_BYTE, stripes.data());
            canvas.gl.GenerateMipmap(GL_TEXTURE_1D);
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
