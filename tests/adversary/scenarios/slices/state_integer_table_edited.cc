// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_integer_table_edited() {
  return {.sentence =
              "The table holds whole numbers, and is read with texelFetch from a usampler2D. It is replaced at "
              "frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform usampler2D table;
in vec3 at;
out vec4 colour;
void main() {
  int entry = int(texture(volume, at).r * 255.0 + 0.5);
  colour = vec4(texelFetch(table, ivec2(entry, 0), 0)) / 255.0;
}
)"});
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame == 0 || frame == 10) {
                const auto colours = frame == 0 ? soft_colours() : other_colours();
                filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
                canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8UI, 256, 1, 0, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE,
                                     colours.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
