// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_table_begins_to_repeat() {
  return {.sentence =
              "Opacity by a second table of 16 bytes, which steep places leave at its end; it repeats from "
              "frame 12 on, and is not filtered from frame 22 on.",
          .expectation = Expectation::either,
          .key_frames = {12, 22},
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
  colour.a *= texture(fade, 5.0 * length(slope(here))).r;)"),
                                               .grid = sampled(48, shells),
                                               .format = {.texel = Texel::unsigned16},
                                               .orbit = {.azimuth = 190, .elevation = 28}});
            std::vector<std::uint8_t> fade;
            for (int i = 0; i < 16; ++i) fade.push_back(static_cast<std::uint8_t>(17 * i));
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_1D, name);
            filter_linearly(canvas, GL_TEXTURE_1D);
            canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_R8, 16, 0, GL_RED, GL_UNSIGNED_BYTE, fade.data());
            scene->program.use();
            scene->program.set("fade", 2);
            return [&canvas, scene](int frame) {
              if (frame == 12 || frame == 22) canvas.gl.ActiveTexture(GL_TEXTURE2);
              if (frame == 12) canvas.gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_REPEAT);
              if (frame == 22) {
                canvas.gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
                canvas.gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
