// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_back_with_a_cut_corner() {
  return {.sentence =
              "Two settings take turns until frame 11; then the second is drawn alone, while the camera jumps "
              "by 40 "
              "degrees a frame. From frame 16 on the first is back with a corner cut away by a uniform, from "
              "frame 23 on "
              "with samples above a value passed over besides.",
          .expectation = Expectation::either,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas,
                {.fragment = over_caster("uniform vec3 cut;\nuniform float most;\nuniform float exchanged;", R"(
    if (all(greaterThan(here, cut)) || value > most) continue;
    colour.rgb = mix(colour.rgb, colour.brg, exchanged);)")});
            return [&canvas, scene](int frame) {
              const bool first = frame < 12 ? frame % 2 == 0 : frame >= 16 && frame % 2 == 1;
              const float jumps = frame < 12 ? 0.0F : 40.0F * static_cast<float>(std::min(frame, 16) - 11);
              scene->program.use();
              scene->program.set("exchanged", first ? 0.0F : 1.0F);
              scene->program.set("cut", first && frame >= 16 ? Vector{0.6F, 0.6F, 0.6F} : Vector{2, 2, 2});
              scene->program.set("most", first && frame >= 23 ? 0.75F : 2.0F);
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->draw_box(camera_at({.azimuth = 30 + jumps}, frame));
            };
          }};
}

}  // namespace adversary::casters
