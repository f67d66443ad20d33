// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_two_boxes() {
  return {
      .sentence =
          "Without blending, the volume is drawn twice in each frame, in boxes that reach into each other: the "
          "second replaces the first, from frame 10 on only where it is nearer, and from frame 20 on they are "
          "drawn in the other order without a depth test.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.blending = Blending::off, .orbit = {.distance = 4}});
        return [&canvas, scene](int frame) {
          const Vector place{0.45F, -0.25F, -0.55F};
          const Camera camera = scene->camera(frame);
          Camera moved = camera;
          moved.eye = camera.eye - place;
          moved.view = camera.view * Matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, place.x, place.y, place.z, 1};
          canvas.begin(0.15F, 0.5F, 0.6F);
          frame / 10 == 1 ? canvas.gl.Enable(GL_DEPTH_TEST) : canvas.gl.Disable(GL_DEPTH_TEST);
          scene->draw_box(frame < 20 ? camera : moved);
          scene->draw_box(frame < 20 ? moved : camera);
        };
      }};
}

}  // namespace adversary::casters
