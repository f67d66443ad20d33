// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_of_two_boxes() {
  return {
      .sentence =
          "The volume is drawn twice in each frame, tested against depth, in boxes that reach into each other, "
          "each over a background of its own with an alpha of 1. From frame 15 on the backgrounds are "
          "exchanged.",
      .expectation = Expectation::either,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform vec3 background;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = vec4(mix(background, sum.rgb / max(sum.a, 1e-6), sum.a), 1.0);"}),
                     .blending = Blending::over,
                     .orbit = {.distance = 4}});
        return [&canvas, scene](int frame) {
          const Vector place{0.5F, 0.3F, -0.6F};
          const Camera camera = scene->camera(frame);
          Camera moved = camera;
          moved.eye = camera.eye - place;
          moved.view = camera.view * Matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, place.x, place.y, place.z, 1};
          const auto draw_over = [&](const Vector& background, const Camera& seen_from) {
            scene->program.use();
            scene->program.set("background", background);
            scene->draw_box(seen_from);
          };
          const Vector light{0.9F, 0.9F, 0.8F};
          const Vector dark{0.1F, 0.15F, 0.3F};
          canvas.begin(0.15F, 0.5F, 0.3F);
          canvas.gl.Enable(GL_DEPTH_TEST);
          draw_over(frame < 15 ? light : dark, camera);
          draw_over(frame < 15 ? dark : light, moved);
        };
      }};
}

}  // namespace adversary::casters
