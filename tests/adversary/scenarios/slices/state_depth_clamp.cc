// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_depth_clamp() {
  return {.sentence =
              "Under GL_DEPTH_CLAMP and a parallel camera. At frame 10 the near plane moves into the middle of "
              "the volume, where it cuts nothing: what is in front of it is drawn all the same.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            canvas.gl.Enable(GL_DEPTH_CLAMP);
            auto scene = slice_scene(canvas, {.orbit = {.projection = Projection::parallel}});
            return [&canvas, scene](int frame) {
              Camera camera = scene->camera(frame);
              if (frame >= 10) {
                const float near_plane = scene->settings.orbit.distance, far_plane = 10;
                camera.projection[10] = 2 / (near_plane - far_plane);
                camera.projection[14] = (near_plane + far_plane) / (near_plane - far_plane);
              }
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->draw_slices(camera);
            };
          }};
}

}  // namespace adversary::slices
