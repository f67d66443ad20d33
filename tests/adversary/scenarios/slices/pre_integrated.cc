// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario pre_integrated() {
  return {.sentence = "Segments between slices: front and back samples look up a pre-integration table.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const auto colours = as_floats(soft_colours());
            std::vector<std::uint8_t> pairs;
            for (std::size_t back = 0; back < 256; back += 2)
              for (std::size_t front = 0; front < 256; front += 2)
                for (std::size_t channel = 0; channel < 4; ++channel)
                  pairs.push_back(static_cast<std::uint8_t>(
                      127.5F * (colours[4 * front + channel] + colours[4 * back + channel])));
            auto scene = slice_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D pairs;
in vec3 at;
in vec3 behind;
out vec4 colour;
void main() { colour = texture(pairs, vec2(texture(volume, at).r, texture(volume, behind).r)); }
)",
                                              .vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
uniform vec3 thickness;
out vec3 at;
out vec3 behind;
void main() {
  at = position;
  behind = position + thickness;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)",
                                              .orbit = {.projection = Projection::parallel}});
            GLuint texture = 0;
            canvas.gl.GenTextures(1, &texture);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_2D, texture);
            filter_linearly(canvas, GL_TEXTURE_2D);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 128, 128, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                 pairs.data());
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("pairs", 2);
              scene->program.set("thickness", 1.732F / 64 * scene->camera(frame).forward);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
