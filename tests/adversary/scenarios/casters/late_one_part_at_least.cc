// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string equal_parts = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 direction = normalize(at - eye);
  vec3 ends = (step(0.0, direction) - at) / direction;
  float way = min(ends.x, min(ends.y, ends.z));
  int parts = max(1, int(way / step_length));
  vec3 part = direction * (way / float(parts));
  vec3 p = at + 0.5 * part;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < parts; ++i) {
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    c.a = 1.0 - pow(1.0 - c.a, step_length / 0.02);
    sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    p += part;
  }
  shown = sum;
}
)";

}  // namespace

Scenario late_one_part_at_least() {
  return {
      .sentence =
          "Every ray is divided into equal parts, as many as whole steps fit into it and at least one, with a "
          "sample in the middle of each; steps are 5 texels long, 18 in frames 9 to 17. Opacities are "
          "corrected for the step.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {9, 18},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas,
            {.fragment = equal_parts, .grid = sampled(60, shells), .orbit = {.azimuth = 70, .elevation = 38}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("step_length", frame >= 9 && frame < 18 ? 0.3F : 5.0F / 60);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
