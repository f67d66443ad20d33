// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_waves_scale_edited() {
  return {.sentence =
              "Waves of 52 x 52 x 52 texels of 16 bits under Lambert's light from the eye on both sides; "
              "opacity by the red of a 1-D table of colours, looked up by the gradient's length times a "
              "uniform, which the user raises at frame 15.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform sampler1D steepness;
uniform float gain;
vec3 slope(vec3 p) {
  const float d = 1.0 / 52.0;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  vec3 g = slope(here);
  float size = length(g);
  colour.a *= texture(steepness, gain * size).r;
  vec3 normal = g / max(size, 1e-5);
  colour.rgb *= 0.3 + 0.7 * abs(dot(normal, direction));)"),
                                               .grid = sampled(52, waves),
                                               .format = {.texel = Texel::unsigned16},
                                               .step_length = 0.02F,
                                               .orbit = {.azimuth = 140, .elevation = 30}});
            std::vector<Colour> steepness;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float peak = std::max(0.0F, 1 - std::abs(at - 0.45F) / 0.28F);
              const auto factor = static_cast<std::uint8_t>(std::lround(255 * peak));
              steepness.push_back({factor, static_cast<std::uint8_t>(255 - factor), 90, 255});
            }
            upload_table_1d(canvas, 2, steepness);
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("steepness", 2);
              scene->program.set("gain", frame < 15 ? 4.0F : 9.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
