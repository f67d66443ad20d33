// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_second_fetch() {
  return {.sentence = "The sample is the mean of two texels; they coincide until frame 9.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform vec3 apart;)",
                                                                       R"(
  colour = texture(table, vec2(0.5 * (value + texture(volume, here + apart).r), 0.5));)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("apart", frame < 10 ? Vector{} : Vector{0.06F, 0.03F, -0.05F});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
