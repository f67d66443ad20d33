// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario parallel_projection() {
  return {.sentence = "Rays of one direction, in parallel projection.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 direction;
uniform float step_length;
in vec3 at;
out vec4 shown;
void main() {
  vec3 ends = (step(0.0, direction) - at) / direction;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec4 colour = texture(table, vec2(texture(volume, at + float(i) * step_length * direction).r, 0.5));
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
  }
  shown = sum;
}
)",
                                                  .orbit = {.projection = Projection::parallel}})](int frame) {
              scene->program.use();
              scene->program.set("direction", scene->camera(frame).forward);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
