// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario state_packed_tint() {
  return {.sentence =
              "A tint of four bytes in one uint: 0xffc0ff00, from frame 10 on 0xffc0ff6e, which is the same "
              "number as a float. The camera stands still.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(uniform uint tint;
vec3 unpacked() {
  return vec3(tint & 0xffu, tint >> 8 & 0xffu, tint >> 16 & 0xffu) / 255.0;
})",
                                                                       "    colour.rgb *= unpacked();"),
                                               .orbit = {.degrees_each_frame = 0}});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.Uniform1ui(scene->program.location("tint"), frame < 10 ? 0xffc0ff00U : 0xffc0ff6eU);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
