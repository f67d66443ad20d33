// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string end_looked_for_afterwards = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 ray = normalize(at - eye);
  vec3 planes = (step(0.0, ray) - at) / ray;
  float end = min(planes.x, min(planes.y, planes.z));
  float t = 0.5 * step_length;
  vec3 colour = vec3(0.0);
  float alpha = 0.0;
  while (true) {
    vec4 c = texture(table, vec2(texture(volume, at + t * ray).r, 0.5));
    float opacity = 1.0 - pow(1.0 - c.a, step_length / 0.025);
    colour += (1.0 - alpha) * opacity * c.rgb;
    alpha += (1.0 - alpha) * opacity;
    t += step_length;
    if (t > end) break;
  }
  shown = vec4(colour, alpha);
}
)";

}  // namespace

Scenario late_half_step_before_the_end() {
  return {.sentence =
              "A sponge whose rays begin half a step in; a sample is taken before the ray's end is looked for. "
              "Steps "
              "are 6 texels long, 30 in frames 7 to 13 and 21 to 26.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {7, 14, 21, 27},
          .start = [](Canvas& canvas) -> DrawFrame {
            const Field sponge = [](float x, float y, float z) {
              const float holes = std::sin(17 * x + 1) * std::cos(15 * y) +
                                  std::sin(13 * y + 2 * z) * std::cos(19 * z) +
                                  std::sin(16 * z) * std::cos(14 * x + 0.5F);
              return std::clamp(0.5F + 0.2F * holes + 0.3F * (x - y), 0.0F, 1.0F);
            };
            auto scene =
                caster_scene(canvas, {.fragment = end_looked_for_afterwards,
                                      .grid = sampled(72, sponge),
                                      .orbit = {.azimuth = 125, .elevation = 33, .degrees_each_frame = 1.4F}});
            return [scene](int frame) {
              const bool dragged = (frame >= 7 && frame < 14) || (frame >= 21 && frame < 27);
              scene->program.use();
              scene->program.set("step_length", dragged ? 30.0F / 72 : 6.0F / 72);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
