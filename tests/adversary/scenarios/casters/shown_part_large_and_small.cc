// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shown_part_large_and_small() {
  return {.sentence =
              "A large and a small view in one window, drawn in turn into the whole viewport, each with the "
              "mean of the values as a grey; a matrix gives each view's place. From frame 15 on the small one "
              "is higher up.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform mat4 view_from_window;",
                 .before = "  vec4 place = view_from_window * vec4(gl_FragCoord.xy, 0.0, 1.0);\n"
                           "  if (any(greaterThan(abs(place.xy), vec2(1.0)))) discard;\n"
                           "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    sum += value;\n    ++taken;",
                 .after = "  shown = vec4(vec3(clamp(sum / float(taken), 0.0, 1.0)), 1.0);"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            const auto show_only = [scene](float x, float y, float half_width, float half_height) {
              scene->program.use();
              scene->program.set("view_from_window",
                                 Matrix{1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, 1, 0,
                                        -x / half_width, -y / half_height, 0, 1});
            };
            return [&canvas, scene, show_only](int frame) {
              show_only(90, 128, 90, 128);
              scene->draw(frame);
              show_only(220, frame < 15 ? 80.0F : 150.0F, 34, 44);
              const float aspect = static_cast<float>(canvas.width()) / static_cast<float>(canvas.height());
              scene->draw_box(camera_at({.azimuth = 120, .sideways = -0.4F}, frame, aspect));
            };
          }};
}

}  // namespace adversary::casters
