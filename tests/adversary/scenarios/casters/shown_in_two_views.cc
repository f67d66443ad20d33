// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shown_in_two_views() {
  return {.sentence =
              "Two views in one window, drawn in turn into the whole viewport; the shader discards what lies "
              "outside of each. From frame 15 on they are of other widths.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec3 low, high;",
                 .before = "  vec2 place = gl_FragCoord.xy;\n"
                           "  if (any(lessThan(place, low.xy)) || any(greaterThan(place, high.xy))) discard;\n"
                           "  vec4 sum = vec4(0.0);",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [scene](int frame) {
              const float middle = frame < 15 ? 128.0F : 90.0F;
              scene->program.use();
              scene->program.set("low", Vector{0, 0, 0});
              scene->program.set("high", Vector{middle, 256, 0});
              scene->draw(frame);
              scene->program.use();
              scene->program.set("low", Vector{middle, 0, 0});
              scene->program.set("high", Vector{256, 256, 0});
              scene->draw_box(scene->camera(frame + 9));
            };
          }};
}

}  // namespace adversary::casters
