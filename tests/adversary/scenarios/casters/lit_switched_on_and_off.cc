// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_switched_on_and_off() {
  return {
      .sentence =
          "A uniform switches light from the eye on at frame 10 and off at frame 20; rays end where they are "
          "nearly opaque.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        // A tooth: crown with four cusps, two roots, a nerve within.
        const Field field = [](float x, float y, float z) {
          const float u = x - 0.5F, v = z - 0.5F;
          const float cusps = 0.05F * std::cos(16 * u) * std::cos(16 * v);
          const float crown = std::exp(-11 * (u * u + v * v) - 24 * std::pow(y - 0.62F - cusps, 2.0F));
          const float spread = 0.14F + 0.1F * (0.6F - y);
          const float depth = std::exp(-9 * std::pow(y - 0.32F, 2.0F));
          const float left = depth * std::exp(-90 * (std::pow(u - spread, 2.0F) + v * v));
          const float right = depth * std::exp(-90 * (std::pow(u + spread, 2.0F) + v * v));
          const float nerve = 0.5F * std::exp(-70 * (u * u + v * v) - 20 * std::pow(y - 0.58F, 2.0F));
          return 1 - (1 - 0.6F * crown) * (1 - 0.55F * left) * (1 - 0.55F * right) * (1 - nerve);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float gum = std::exp(-std::pow((at - 0.18F) / 0.05F, 2.0F));
          const float dentine = std::exp(-std::pow((at - 0.44F) / 0.1F, 2.0F));
          const float pulp = std::exp(-std::pow((at - 0.75F) / 0.1F, 2.0F));
          const float all = gum + dentine + pulp + 1e-9F;
          table.push_back({static_cast<std::uint8_t>((190 * gum + 200 * dentine + 160 * pulp) / all),
                           static_cast<std::uint8_t>((90 * gum + 185 * dentine + 30 * pulp) / all),
                           static_cast<std::uint8_t>((100 * gum + 140 * dentine + 60 * pulp) / all),
                           static_cast<std::uint8_t>(std::lround(10 * gum + 60 * dentine + 90 * pulp))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
precision highp float;
in vec3 at;
out vec4 color;
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform bool shading;

void main() {
  vec3 rayDirection = normalize(at - eye);
  vec3 deltas = rayDirection * step_length;
  vec3 exits = (step(0.0, rayDirection) - at) / rayDirection;
  float rayLength = min(exits.x, min(exits.y, exits.z));
  vec3 voxelSize = vec3(1.0) / vec3(textureSize(volume, 0));
  vec4 acc = vec4(0.0);
  vec3 pos = at;
  for (float travelled = 0.0; travelled < rayLength && acc.a < 0.96; travelled += step_length, pos += deltas) {
    vec4 c = texture(table, vec2(texture(volume, pos).r, 0.5));
    if (shading && c.a > 0.0) {
      vec3 s1, s2;
      for (int k = 0; k < 3; k++) {
        vec3 e = vec3(k == 0 ? voxelSize.x : 0.0, k == 1 ? voxelSize.y : 0.0, k == 2 ? voxelSize.z : 0.0);
        s1[k] = texture(volume, pos - e).r;
        s2[k] = texture(volume, pos + e).r;
      }
      vec3 N = s1 - s2;
      N = N / max(length(N), 1e-6);
      vec3 L = -rayDirection;
      float d = max(dot(N, L), 0.0);
      vec3 R = 2.0 * d * N - L;
      float s = d > 0.0 ? pow(max(dot(R, L), 0.0), 8.0) : 0.0;
      c.rgb = c.rgb * (0.2 + 0.7 * d) + 0.15 * s;
    }
    c.rgb *= c.a;
    acc = acc + (1.0 - acc.a) * c;
  }
  color = acc;
}
)",
                                  .grid = sampled(64, field),
                                  .table = table,
                                  .step_length = 0.02F,
                                  .orbit = {.azimuth = 150, .elevation = 25, .degrees_each_frame = 2}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("shading", frame >= 10 && frame < 20 ? 1 : 0);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
