// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_weak_light_in_the_world() {
  return {
      .sentence =
          "A light at the eye, and a weaker one fixed in the world, whose light a short second ray through the "
          "table weakens.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        // A tree: trunk, three crowns, fruit.
        const Field field = [](float x, float y, float z) {
          const auto ball = [&](float cx, float cy, float cz, float amount, float narrow) {
            const float a = x - cx, b = y - cy, c = z - cz;
            return 1 - amount * std::exp(-narrow * (a * a + b * b + c * c));
          };
          const float u = x - 0.5F - 0.04F * std::sin(8 * y), w = z - 0.5F;
          const float trunk = 1 - 0.85F * std::exp(-170 * (u * u + w * w) - 14 * std::pow(y - 0.25F, 2.0F));
          return 1 - trunk * ball(0.5F, 0.72F, 0.5F, 0.5F, 26) * ball(0.3F, 0.58F, 0.42F, 0.45F, 40) *
                         ball(0.68F, 0.56F, 0.62F, 0.45F, 36) * ball(0.3F, 0.52F, 0.62F, 0.9F, 160) *
                         ball(0.62F, 0.6F, 0.28F, 0.9F, 140) * ball(0.8F, 0.72F, 0.5F, 0.9F, 150);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float leaves = std::exp(-std::pow((at - 0.3F) / 0.08F, 2.0F));
          const float wood = std::exp(-std::pow((at - 0.7F) / 0.13F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(at < 0.5F ? 90 : 200),
                           static_cast<std::uint8_t>(at < 0.5F ? 185 : 90),
                           static_cast<std::uint8_t>(at < 0.5F ? 70 : 60),
                           static_cast<std::uint8_t>(std::lround(28 * leaves + 65 * wood))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

const vec3 sun = vec3(0.36, 0.8, -0.48);

vec4 material(vec3 p) { return texture(table, vec2(texture(volume, p).r, 0.5)); }

vec3 slope(vec3 p) {
  const float d = 1.0 / 64.0;
  vec3 s;
  s.x = texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r;
  s.y = texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r;
  s.z = texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r;
  return s;
}

float reaches(vec3 p) {
  float clear = 1.0;
  for (int j = 1; j <= 5; ++j) clear *= 1.0 - material(p + 0.035 * float(j) * sun).a;
  return clear;
}

void main() {
  vec3 direction = normalize(at - eye);
  vec3 ends = (step(0.0, direction) - at) / direction;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec3 p = at + float(i) * step_length * direction;
    vec4 c = material(p);
    if (c.a > 0.0) {
      vec3 g = slope(p);
      vec3 n = -g / max(length(g), 1e-6);
      float own = max(dot(n, -direction), 0.0);
      float other = max(dot(n, sun), 0.0) * reaches(p);
      c.rgb *= 0.25 + 0.45 * own + 0.3 * other;
      sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    }
  }
  shown = sum;
}
)",
                                  .grid = sampled(64, field),
                                  .table = table,
                                  .step_length = 0.02F,
                                  .orbit = {.azimuth = 100, .elevation = 20, .degrees_each_frame = 3}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
