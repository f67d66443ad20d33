// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario srgb_table_no_longer_decoded() {
  return {
      .sentence = "The table's colours are sRGB. From frame 10 on they are looked up without being decoded.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas);
        canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                             soft_colours().data());
        return [&canvas, scene](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE1);
          if (frame == 10)
            canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SRGB_DECODE_EXT, GL_SKIP_DECODE_EXT);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
