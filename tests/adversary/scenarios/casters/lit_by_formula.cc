// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_by_formula() {
  return {
      .sentence =
          "Two materials by a formula instead of a table, half floats, light from the eye on both sides with "
          "highlights; gradients over a fixed 0.01, which is less than a voxel.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        // A shell with waves on it, and a ring within.
        const Field field = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.5F, c = z - 0.5F;
          const float radius = std::sqrt(a * a + b * b + c * c);
          const float wave = 0.025F * std::sin(14 * a + 3) * std::sin(12 * b) * std::cos(13 * c);
          const float shell = 0.34F * std::exp(-170 * std::pow(radius - 0.38F + wave, 2.0F));
          const float p = std::hypot(a, c) - 0.16F, q = b - 0.05F * std::sin(3 * std::atan2(c, a));
          const float ring = 0.95F * std::exp(-170 * (p * p + q * q));
          return 1 - (1 - shell) * (1 - ring);
        };
        auto scene = caster_scene(canvas, {.fragment = R"(#version 400 core
uniform sampler3D volume;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 color;

vec4 classify(float density) {
  float thin = smoothstep(0.14, 0.26, density) * (1.0 - smoothstep(0.32, 0.44, density));
  float dense = smoothstep(0.5, 0.72, density);
  vec3 tint = mix(vec3(0.3, 0.62, 0.7), vec3(0.76, 0.66, 0.42), smoothstep(0.36, 0.6, density));
  return vec4(tint, 0.07 * thin + 0.28 * dense);
}

vec3 normalAt(vec3 p) {
  const vec2 e = vec2(0.01, 0.0);
  vec3 g = vec3(texture(volume, p + e.xyy).r, texture(volume, p + e.yxy).r, texture(volume, p + e.yyx).r)
         - vec3(texture(volume, p - e.xyy).r, texture(volume, p - e.yxy).r, texture(volume, p - e.yyx).r);
  return g * inversesqrt(max(dot(g, g), 1e-12));
}

void main() {
  vec3 ray = normalize(at - eye);
  vec3 leave = (step(vec3(0.0), ray) - at) / ray;
  float way = min(min(leave.x, leave.y), leave.z);
  int steps = int(floor(way / step_length));
  vec3 rgb = vec3(0.0);
  float through = 1.0;
  for (int k = 0; k <= steps; ++k) {
    vec3 p = at + ray * (step_length * float(k));
    vec4 c = classify(texture(volume, p).r);
    float d = abs(dot(normalAt(p), ray));
    rgb += through * c.a * (c.rgb * (0.22 + 0.66 * d) + vec3(0.18) * pow(d, 10.0));
    through *= 1.0 - c.a;
  }
  color = vec4(rgb, 1.0 - through);
}
)",
                                           .grid = sampled(72, field),
                                           .format = {.texel = Texel::half},
                                           .step_length = 0.02F,
                                           .orbit = {.azimuth = 110, .elevation = 35}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
