// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario double_gain() {
  return {.sentence =
              "GLSL 4.00 multiplies colours by a double and by a column of a mat2x3. The double changes at "
              "frame 10, the matrix at frame 20.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string fragment = R"(#version 400
uniform sampler3D volume;
uniform sampler2D table;
uniform double gain;
uniform mat2x3 tint;
in vec3 at;
out vec4 colour;
void main() {
  colour = texture(table, vec2(texture(volume, at).r, 0.5));
  colour.rgb *= float(gain) * tint[1];
}
)";
            auto scene = slice_scene(canvas, {.fragment = fragment});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.Uniform1d(scene->program.location("gain"), frame < 10 ? 1.0 : 0.4);
              const float blue = frame < 20 ? 1.0F : 0.3F;
              const std::array<float, 6> tint{0, 0, 0, 1, 0.8F, blue};
              canvas.gl.UniformMatrix2x3fv(scene->program.location("tint"), 1, GL_FALSE, tint.data());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
