// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario two_volumes() {
  return {.sentence = "Two volumes with tables of their own in one scene, drawn one behind the other.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto back = slice_scene(canvas);
            auto front = slice_scene(canvas, {.grid = sampled(40, shells), .table = other_colours()});
            return [&canvas, back, front](int frame) {
              const Camera camera = back->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              const auto draw = [&](const SliceScene& scene, Vector move) {
                Matrix object = identity;
                for (int i = 0; i < 3; ++i) object[5 * i] = 0.6F;
                object[12] = move.x, object[13] = move.y, object[14] = move.z;
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.BindTexture(GL_TEXTURE_2D, scene.table);
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                canvas.gl.BindTexture(GL_TEXTURE_3D, scene.volume);
                scene.program.use();
                scene.program.set("clip_from_object", camera.clip_from_object() * object);
                set_blending(canvas.gl, Blending::over);
                scene.vertices.draw(triangles(view_aligned_slices(camera, 64)));
              };
              draw(*back, {0.6F, 0.2F, -0.1F});
              draw(*front, {-0.2F, 0.2F, 0.5F});
            };
          }};
}

}  // namespace adversary::slices
