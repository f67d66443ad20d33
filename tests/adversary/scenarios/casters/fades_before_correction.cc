// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_before_correction() {
  return {
      .sentence =
          "Opacity is multiplied by an entry of a table of gradients, and corrected for a quarter of the step "
          "then; at frame 12 colours become nearly opaque.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform sampler1D fade;
vec3 slope(vec3 p) {
  const float d = 1.0 / 48.0;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                   R"(
  colour.a *= texture(fade, clamp(3.0 * length(slope(here)), 0.0, 1.0)).r;
  colour.a = 1.0 - pow(1.0 - colour.a, 0.25);)"),
                                           .grid = sampled(48, shells),
                                           .orbit = {.azimuth = 75, .elevation = 25}});
        std::vector<std::uint8_t> fade;
        for (int i = 0; i < 64; ++i) {
          const float at = static_cast<float>(i) / 63;
          const float rise = std::clamp((at - 0.15F) / 0.4F, 0.0F, 1.0F);
          const float fall = 1 - 0.7F * std::clamp((at - 0.65F) / 0.3F, 0.0F, 1.0F);
          fade.push_back(static_cast<std::uint8_t>(std::lround(255 * rise * fall)));
        }
        GLuint name = 0;
        canvas.gl.GenTextures(1, &name);
        canvas.gl.ActiveTexture(GL_TEXTURE2);
        canvas.gl.BindTexture(GL_TEXTURE_1D, name);
        filter_linearly(canvas, GL_TEXTURE_1D);
        canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_R8, 64, 0, GL_RED, GL_UNSIGNED_BYTE, fade.data());
        scene->program.use();
        scene->program.set("fade", 2);
        return [scene, &canvas](int frame) {
          if (frame == 12) {
            std::vector<Colour> dense = scene->settings.table;
            for (Colour& entry : dense) entry[3] = static_cast<std::uint8_t>(std::min(255, 8 * entry[3]));
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.BindTexture(GL_TEXTURE_2D, scene->table);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, static_cast<GLsizei>(dense.size()), 1, GL_RGBA,
                                    GL_UNSIGNED_BYTE, dense.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
