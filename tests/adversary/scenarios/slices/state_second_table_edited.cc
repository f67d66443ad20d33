// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_second_table_edited() {
  return {.sentence =
              "An array of two samplers: opacities come from the first table, colours from the second, which "
              "is replaced at frame 10.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D tables[2];
in vec3 at;
out vec4 colour;
void main() {
  vec2 entry = vec2(texture(volume, at).r, 0.5);
  colour = vec4(texture(tables[1], entry).rgb, texture(tables[0], entry).a);
}
)"});
            upload_table_2d(canvas, 2, soft_colours());
            scene->program.set("tables[0]", 1);
            scene->program.set("tables[1]", 2);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE2);
              if (frame == 10)
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        other_colours().data());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
