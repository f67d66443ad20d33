// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_light_turns_warm() {
  return {
      .sentence =
          "The light at the eye has a colour by a uniform: white, from frame 10 on orange, from frame 20 on "
          "blue. The ambient part stays white.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        // Ripples of three values on a bowl, and a marble in it.
        const Field field = [](float x, float y, float z) {
          const float u = x - 0.5F, w = z - 0.5F, round = u * u + w * w;
          const float bowl = y - 0.25F - 1.4F * round - 0.02F * std::cos(45 * std::sqrt(round));
          const float wall = (0.55F + 0.2F * std::sin(6 * x)) * std::exp(-150 * bowl * bowl);
          const float a = x - 0.45F, b = y - 0.52F, c = z - 0.55F;
          const float marble = 0.9F * std::exp(-50 * (a * a + b * b + c * c));
          return 1 - (1 - wall) * (1 - marble);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float china = std::exp(-std::pow((at - 0.3F) / 0.08F, 2.0F));
          const float stone = std::exp(-std::pow((at - 0.7F) / 0.12F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(160 + 30 * at), static_cast<std::uint8_t>(190 - 40 * at),
                           static_cast<std::uint8_t>(150 + 20 * china),
                           static_cast<std::uint8_t>(std::lround(26 * china + 55 * stone))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
struct Source { vec3 position; vec3 colour; };
uniform Source source;
in vec3 at;
out vec4 shown;

vec3 normal_at(in vec3 p, in vec3 d) {
  vec3 n = vec3(texture(volume, p - vec3(d.x, 0.0, 0.0)).r, texture(volume, p - vec3(0.0, d.y, 0.0)).r,
                texture(volume, p - vec3(0.0, 0.0, d.z)).r);
  n -= vec3(texture(volume, p + vec3(d.x, 0.0, 0.0)).r, texture(volume, p + vec3(0.0, d.y, 0.0)).r,
            texture(volume, p + vec3(0.0, 0.0, d.z)).r);
  return n / (length(n) + 1e-7);
}

void main() {
  vec3 direction = normalize(at - eye);
  vec3 ends = (step(0.0, direction) - at) / direction;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec3 p = at + float(i) * step_length * direction;
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    if (c.a <= 0.0) continue;
    vec3 n = normal_at(p, vec3(1.0 / 64.0));
    vec3 l = normalize(source.position - p);
    float front = abs(dot(n, l));
    vec3 light = vec3(0.25) + 0.55 * front * source.colour;
    vec3 gloss = 0.2 * pow(front, 18.0) * source.colour;
    sum += (1.0 - sum.a) * vec4((c.rgb * light + gloss) * c.a, c.a);
  }
  shown = sum;
}
)",
                                  .grid = sampled(64, field),
                                  .table = table,
                                  .step_length = 0.02F,
                                  .orbit = {.azimuth = -15, .elevation = 42, .degrees_each_frame = 2}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("source.position", scene->camera(frame).eye);
          scene->program.set("source.colour", frame < 10   ? Vector{1, 1, 1}
                                              : frame < 20 ? Vector{1, 0.7F, 0.35F}
                                                           : Vector{0.4F, 0.65F, 1});
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
