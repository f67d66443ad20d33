// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_reinhard_thin_then_dense() {
  return {
      .sentence =
          "A jellyfish of 48 x 48 x 48 floats in GLSL 4.20: the composed colour is mapped to c * (1 + c / 4) / "
          "(1 "
          "+ c) after the loop, its alpha stays; while the table is thin, that changes hardly anything. From "
          "frame 10 on its opacities are eight times as large.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field jelly = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.6F, c = z - 0.5F;
          const float radius = std::sqrt(a * a + 1.4F * b * b + c * c);
          const float hump = b > -0.05F ? std::exp(-140 * (radius - 0.34F) * (radius - 0.34F)) : 0.0F;
          const float round = std::sqrt(a * a + c * c);
          const float arms = y < 0.62F
                                 ? std::exp(-90 * std::pow(round - 0.2F - 0.04F * std::sin(16 * y), 2.0F)) *
                                       std::max(0.0F, std::sin(7 * std::atan2(c, a) + 5 * y))
                                 : 0.0F;
          return std::clamp(0.05F + 0.7F * hump + 0.8F * arms + 0.2F * std::exp(-25 * radius * radius), 0.0F,
                            1.0F);
        };
        const auto table_of = [](float factor) {
          std::vector<Colour> colours;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            colours.push_back({static_cast<std::uint8_t>(210 + 40 * at),
                               static_cast<std::uint8_t>(150 + 70 * std::sin(5 * at)),
                               static_cast<std::uint8_t>(170 + 80 * at),
                               static_cast<std::uint8_t>(std::lround(std::min(255.0F, factor * 8 * at)))});
          }
          return colours;
        };
        auto scene = caster_scene(
            canvas, {.fragment = R"(#version 420 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
layout(location = 0) out vec4 fragmentColour;

vec3 toneMap(vec3 c) { return c * (1.0 + c / 4.0) / (1.0 + c); }

void main() {
  const vec3 v = normalize(at - eye);
  const vec3 leave = (step(0.0, v) - at) / v;
  const float len = min(leave.x, min(leave.y, leave.z));
  vec4 front = vec4(0.0);
  for (float s = 0.5 * step_length; s < len; s += step_length) {
    vec4 entry = texture(table, vec2(texture(volume, fma(vec3(s), v, at)).r, 0.5));
    front += (1.0 - front.a) * vec4(entry.rgb, 1.0) * entry.a;
  }
  fragmentColour = vec4(toneMap(front.rgb), front.a);
}
)",
                     .grid = sampled(48, jelly),
                     .format = {.texel = Texel::float32},
                     .table = table_of(1),
                     .step_length = 0.018F,
                     .orbit = {.azimuth = 60, .elevation = 12, .distance = 2.3F, .degrees_each_frame = 2.5F},
                     .background = {0.02F, 0.05F, 0.15F, 1}});
        return [scene, table_of](int frame) {
          if (frame == 10) {
            const auto colours = table_of(8);
            scene->canvas.gl.ActiveTexture(GL_TEXTURE1);
            scene->canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                           colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
