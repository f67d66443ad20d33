// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_two_boxes_exchange() {
  return {
      .sentence =
          "Three boxes in each frame, each with a window of values and a tint of its own. At frame 10 two "
          "exchange "
          "their windows, but not their tints; at frame 20 the third takes the first's, but 16/255 greener.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene =
            caster_scene(canvas, {.fragment = over_caster("uniform float low, high;\nuniform vec3 tint;", R"(
    float grey = clamp((value - low) / (high - low), 0.0, 1.0);
    colour = vec4(0.5 * grey + tint, 0.15 * grey);)"),
                                  .orbit = {.distance = 4.4F}});
        return [&canvas, scene](int frame) {
          const Camera camera = scene->camera(frame);
          const auto draw_at = [&](const Vector& place, float low, float high, const Vector& tint) {
            Camera moved = camera;
            moved.eye = camera.eye - place;
            moved.view = camera.view * Matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, place.x, place.y, place.z, 1};
            scene->program.use();
            scene->program.set("low", low);
            scene->program.set("high", high);
            scene->program.set("tint", tint);
            scene->draw_box(moved);
          };
          const bool exchanged = frame >= 10;
          const Vector warm{0.45F, 0.25F, 0.1F}, cold{0.1F, 0.25F, 0.45F};
          const Vector greener = warm + Vector{0, 16 / 255.0F, 0};
          canvas.begin(0.1F, 0.12F, 0.2F);
          draw_at({-0.3F, -0.4F, -0.8F}, exchanged ? 0.55F : 0.3F, exchanged ? 0.8F : 0.75F, warm);
          draw_at({0.4F, 0.3F, 0}, exchanged ? 0.3F : 0.55F, exchanged ? 0.75F : 0.8F, cold);
          draw_at({-0.6F, 0.5F, 0.4F}, frame >= 20 ? 0.55F : 0.2F, frame >= 20 ? 0.8F : 0.9F,
                  frame >= 20 ? greener : Vector{0.2F, 0.4F, 0.2F});
        };
      }};
}

}  // namespace adversary::casters
