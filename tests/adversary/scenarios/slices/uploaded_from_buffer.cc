// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario uploaded_from_buffer() {
  return {.sentence = "Another volume comes from a pixel buffer at frame 10.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            std::vector<float> values = sampled(48, shells).values;
            for (float& value : values) value = std::round(255 * value) / 255;
            GLuint buffer = 0;
            canvas.gl.GenBuffers(1, &buffer);
            canvas.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
            canvas.gl.BufferData(GL_PIXEL_UNPACK_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(float)),
                                 values.data(), GL_STATIC_DRAW);
            canvas.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
            return [&canvas, buffer, scene = slice_scene(canvas)](int frame) {
              if (frame == 10) {
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                canvas.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
                canvas.gl.TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 48, 48, 48, GL_RED, GL_FLOAT, nullptr);
                canvas.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
