// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario label_of_16_bits_recoloured() {
  return {.sentence =
              "Labels of 16 bits, filtered by the nearest texel, have a table of 256 x 256 colours. A block "
              "has the "
              "label 30001, which becomes red at frame 10.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            constexpr int label = 30001;
            Grid grid = sampled(48, waves);
            grid.values.front() = 0;
            grid.values.back() = 1;
            const VolumeFormat format{.texel = Texel::unsigned16, .filter = GL_NEAREST};
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("uniform sampler2D labels;", R"(
  int label = int(65535.0 * value + 0.5);
  colour = texelFetch(labels, ivec2(label % 256, label / 256), 0);)"),
                                              .grid = grid,
                                              .format = format});
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            replace_texels(canvas, sampled(24, [](float, float, float) { return label / 65535.0F; }), format,
                           12, 12, 12);
            std::vector<Colour> colours;
            const std::vector<Colour> soft = soft_colours();
            for (std::size_t i = 0; i < 65536; ++i) colours.push_back(soft[i / 256]);
            upload_table_2d(canvas, 2, colours, 256, GL_NEAREST);
            scene->program.set("labels", 2);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE2);
              constexpr Colour red{255, 0, 0, 120};
              if (frame == 10)
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, label % 256, label / 256, 1, 1, GL_RGBA,
                                        GL_UNSIGNED_BYTE, red.data());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
