// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_gamma_turned_on() {
  return {
      .sentence =
          "A seed pod of 48 x 40 x 56 16-bit texels in GLSL 3.30: the composed, premultiplied colour is raised "
          "to 1 / gamma after the loop, its alpha stays. Gamma is 1 until frame 9, 1.15 from frame 10 on and "
          "2.2 from frame 20 on.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field pod = [](float x, float y, float z) {
          const float a = (x - 0.5F) / 0.45F, b = (y - 0.48F) / 0.35F, c = (z - 0.52F) / 0.45F;
          const float radius = std::sqrt(a * a + b * b + c * c);
          const float seeds = std::sin(13 * x + 1) * std::sin(11 * y) * std::sin(12 * z + 2);
          const float husk = std::exp(-60 * (radius - 0.9F) * (radius - 0.9F));
          return std::clamp(0.12F + 0.5F * husk + (radius < 0.85F ? 0.75F * std::abs(seeds) : 0.0F), 0.0F,
                            1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float body = std::clamp((at - 0.25F) / 0.5F, 0.0F, 1.0F);
          colours.push_back({static_cast<std::uint8_t>(220 * at + 20),
                             static_cast<std::uint8_t>(170 - 110 * at),
                             static_cast<std::uint8_t>(60 + 90 * std::cos(5 * at)),
                             static_cast<std::uint8_t>(std::lround(2 + 34 * body))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform float gamma;
in vec3 at;
out vec4 outColor;

void main() {
  vec3 rd = normalize(at - eye);
  vec3 far = (step(vec3(0.0), rd) - at) / rd;
  float tmax = min(min(far.x, far.y), far.z);
  vec3 acc = vec3(0.0);
  float opacity = 0.0;
  for (float t = 0.0; t < tmax; t += step_length) {
    float s = texture(volume, at + t * rd).r;
    vec4 tf = texture(table, vec2(s, 0.5));
    acc += (1.0 - opacity) * tf.a * tf.rgb;
    opacity += (1.0 - opacity) * tf.a;
    if (opacity > 0.99) break;
  }
  outColor = vec4(pow(acc, vec3(1.0 / gamma)), opacity);
}
)",
                     .grid = sampled(48, 40, 56, pod),
                     .format = {.texel = Texel::unsigned16},
                     .table = colours,
                     .step_length = 0.016F,
                     .orbit = {.azimuth = 70, .elevation = 28, .distance = 2.3F, .degrees_each_frame = 2.5F}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("gamma", frame < 10 ? 1.0F : frame < 20 ? 1.15F : 2.2F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
