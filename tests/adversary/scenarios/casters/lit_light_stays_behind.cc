// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_light_stays_behind() {
  return {
      .sentence =
          "The light's position is the eye's until frame 12; then the light stays where it is in the world, "
          "while "
          "the camera turns on by 4 degrees a frame.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        // A mound with four stones of two kinds.
        const Field field = [](float x, float y, float z) {
          const auto stone = [&](Vector centre, float amount, float narrow) {
            const Vector from = Vector{x, y, z} - centre;
            return 1 - amount * std::exp(-narrow * dot(from, from));
          };
          const float height = y - 0.3F - 0.06F * std::sin(9 * x) * std::sin(8 * z);
          const float mound = 1 - 0.45F / (1 + std::exp(18 * height));
          return 1 - mound * stone({0.3F, 0.55F, 0.3F}, 0.9F, 45) * stone({0.7F, 0.5F, 0.35F}, 0.7F, 55) *
                         stone({0.4F, 0.5F, 0.72F}, 0.75F, 50) * stone({0.72F, 0.62F, 0.7F}, 0.92F, 40);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float earth = std::exp(-std::pow((at - 0.25F) / 0.08F, 2.0F));
          const float rock = std::clamp((at - 0.45F) / 0.2F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(170 - 60 * rock),
                           static_cast<std::uint8_t>(120 + 50 * rock),
                           static_cast<std::uint8_t>(70 + 110 * rock * at),
                           static_cast<std::uint8_t>(std::lround(30 * earth + 60 * rock))});
        }
        auto scene = caster_scene(canvas, {.fragment = R"(#version 330 core
in vec3 at;
out vec4 result;
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform vec3 source;
uniform float step_length;

vec3 outward(vec3 p) {
  ivec3 size = textureSize(volume, 0);
  vec3 texel = 1.0 / vec3(size);
  vec3 g = vec3(
    texture(volume, vec3(p.x - texel.x, p.y, p.z)).r - texture(volume, vec3(p.x + texel.x, p.y, p.z)).r,
    texture(volume, vec3(p.x, p.y - texel.y, p.z)).r - texture(volume, vec3(p.x, p.y + texel.y, p.z)).r,
    texture(volume, vec3(p.x, p.y, p.z - texel.z)).r - texture(volume, vec3(p.x, p.y, p.z + texel.z)).r);
  return dot(g, g) == 0.0 ? g : normalize(g);
}

void main() {
  vec3 d = normalize(at - eye);
  vec3 sides = (step(0.0, d) - at) / d;
  float end = min(sides.x, min(sides.y, sides.z));
  vec3 colour = vec3(0.0);
  float alpha = 0.0;
  for (float t = 0.0; t < end; t += step_length) {
    vec3 p = at + t * d;
    vec4 entry = texture(table, vec2(texture(volume, p).r, 0.5));
    if (entry.a > 0.0) {
      float lambert = max(0.0, dot(outward(p), normalize(source - p)));
      float part = (1.0 - alpha) * entry.a;
      colour += part * entry.rgb * (0.25 + 0.75 * lambert);
      alpha += part;
    }
  }
  result = vec4(colour, alpha);
}
)",
                                           .grid = sampled(64, field),
                                           .table = table,
                                           .step_length = 0.02F,
                                           .orbit = {.elevation = 30, .degrees_each_frame = 4}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("source", scene->camera(std::min(frame, 11)).eye);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
