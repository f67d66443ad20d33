// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario label_of_16_bits_painted() {
  return {
      .sentence =
          "A volume of 16 bits, filtered by the nearest texel, has values from 0 to 65535. The shader shows "
          "the value 30001 in red, and all others by a table. From frame 10 on a block has that value. The "
          "camera stays.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        constexpr float label = 30001.0F / 65535;
        Grid grid = sampled(48, waves);
        for (float& value : grid.values)
          if (std::abs(value - label) < 0.001F) value = label + 0.001F;
        grid.values.front() = 0;
        grid.values.back() = 1;
        const VolumeFormat format{.texel = Texel::unsigned16, .filter = GL_NEAREST};
        auto scene = caster_scene(canvas, {.fragment = over_caster("", R"(
  if (int(65535.0 * value + 0.5) == 30001) colour = vec4(1.0, 0.0, 0.0, 0.5);)"),
                                           .grid = grid,
                                           .format = format,
                                           .orbit = {.degrees_each_frame = 0}});
        const Grid block = sampled(24, [](float, float, float) { return label; });
        return [&canvas, scene, block, format](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE0);
          if (frame == 10) replace_texels(canvas, block, format, 12, 12, 12);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
