// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_occluded_by_neighbours() {
  return {
      .sentence =
          "Light from the eye, darkened where the six neighbours that give the gradient are denser than the "
          "sample: no fetch more than plain light has.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        // A walnut: a ball with deep grooves, halved by a wall, and a harder half kernel.
        const Field field = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.5F, c = z - 0.5F;
          const float radius = std::sqrt(a * a + b * b + c * c) + 1e-4F;
          const float grooves =
              0.035F * std::sin(26 * a + 5 * std::sin(9 * b)) * std::cos(24 * b) + 0.02F * std::sin(30 * c);
          const float shell = 0.55F * std::exp(-210 * std::pow(radius - 0.36F - grooves, 2.0F));
          const float off = a - 0.1F, ribs = 0.75F + 0.2F * std::sin(20 * b);
          const float kernel = 0.9F * ribs * std::exp(-34 * (off * off + b * b + c * c));
          return 1 - (1 - shell) * (1 - kernel);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float husk = std::exp(-std::pow((at - 0.38F) / 0.11F, 2.0F));
          const float meat = std::exp(-std::pow((at - 0.75F) / 0.12F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(200), static_cast<std::uint8_t>(130 + 70 * at),
                           static_cast<std::uint8_t>(70 + 60 * at),
                           static_cast<std::uint8_t>(std::lround(32 * husk + 60 * meat))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  const float r = 2.0 / 64.0;
  vec3 rd = normalize(at - eye);
  vec3 ends = (step(0.0, rd) - at) / rd;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec3 light = vec3(0.0);
  float T = 1.0;
  for (int i = 0; i < count; ++i) {
    vec3 p = at + float(i) * step_length * rd;
    float centre = texture(volume, p).r;
    vec4 c = texture(table, vec2(centre, 0.5));
    float px = texture(volume, p + vec3(r, 0, 0)).r, mx = texture(volume, p - vec3(r, 0, 0)).r;
    float py = texture(volume, p + vec3(0, r, 0)).r, my = texture(volume, p - vec3(0, r, 0)).r;
    float pz = texture(volume, p + vec3(0, 0, r)).r, mz = texture(volume, p - vec3(0, 0, r)).r;
    vec3 g = vec3(px - mx, py - my, pz - mz);
    float facing = abs(dot(g, rd)) / max(length(g), 1e-6);
    float crowd = (px + mx + py + my + pz + mz) / 6.0 - centre;
    float open = clamp(0.85 - 9.0 * crowd, 0.2, 1.0);
    light += T * c.a * c.rgb * open * (0.3 + 0.7 * facing);
    T *= 1.0 - c.a;
  }
  shown = vec4(light, 1.0 - T);
}
)",
                                  .grid = sampled(64, field),
                                  .table = table,
                                  .step_length = 0.02F,
                                  .orbit = {.azimuth = 260, .elevation = 10, .degrees_each_frame = 2}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
