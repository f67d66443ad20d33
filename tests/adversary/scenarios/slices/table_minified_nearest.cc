// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario table_minified_nearest() {
  return {
      .sentence =
          "A table, linear where magnified and nearest where minified, is a ramp of greys. At frame 10 every "
          "second of its texels becomes transparent.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<Colour> ramp(256);
        std::vector<Colour> stripes(256);
        for (int i = 0; i < 256; ++i) {
          const auto grey = static_cast<std::uint8_t>(i);
          ramp[i] = {grey, grey, grey, 20};
          stripes[i] = i % 2 == 0 ? Colour{255, 255, 40, 240} : Colour{255, 255, 40, 0};
        }
        auto scene = slice_scene(canvas, {.table = ramp, .slices = 8});
        canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        return [&canvas, scene, stripes](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE1);
          if (frame == 10)
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, stripes.data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
