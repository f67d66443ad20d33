// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_by_forward_differences() {
  return {.sentence =
              "Opacity by a second table, looked up by the length of forward differences, neighbour less "
              "sample, in 40 x 56 x 48 floats under a light from the eye.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform sampler1D fade;
uniform float gain;
)",
                                                                       R"(
  vec3 g = vec3(texture(volume, here + vec3(1.0 / 40.0, 0.0, 0.0)).r,
                texture(volume, here + vec3(0.0, 1.0 / 56.0, 0.0)).r,
                texture(volume, here + vec3(0.0, 0.0, 1.0 / 48.0)).r) - value;
  float size = length(g);
  colour.a *= texture(fade, gain * size).r;
  colour.rgb *= 0.4 + 0.6 * (size > 0.0 ? abs(dot(g / size, direction)) : 0.0);)"),
                                               .grid = sampled(40, 56, 48, shells),
                                               .format = {.texel = Texel::float32},
                                               .step_length = 0.02F,
                                               .orbit = {.azimuth = 300, .elevation = 35}});
            std::vector<float> fade;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              fade.push_back(std::max(0.0F, 1 - std::abs(at - 0.6F) / 0.35F));
            }
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_1D, name);
            filter_linearly(canvas, GL_TEXTURE_1D);
            canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_R32F, 256, 0, GL_RED, GL_FLOAT, fade.data());
            scene->program.use();
            scene->program.set("fade", 2);
            scene->program.set("gain", 5.0F);
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
