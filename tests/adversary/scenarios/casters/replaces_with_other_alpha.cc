// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_with_other_alpha() {
  return {
      .sentence =
          "Without blending; colour is added afterwards where the window's alpha is low. By a uniform, alpha "
          "is "
          "the opacity, from frame 10 on its square, and from frame 17 on the ray's length beside a colour "
          "that "
          "is not premultiplied; from frame 24 on it is the opacity again, but masked.",
      .expectation = Expectation::either,
      .key_frames = {10, 17, 24},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto tint = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
out vec4 colour;
void main() { colour = vec4(0.5, 0.3, 0.15, 0.0); }
)");
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader(
                 {.declarations = "uniform int alpha_is;",
                  .before = "  vec4 sum = vec4(0.0);",
                  .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                          "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                  .after = "  shown = sum;\n"
                           "  if (alpha_is == 1) shown.a = sum.a * sum.a;\n"
                           "  if (alpha_is == 2)\n"
                           "    shown = vec4(sum.rgb / max(sum.a, 1e-6), float(count) * step_length / 2.0);"}),
             .blending = Blending::off});
        return [&canvas, tint, scene](int frame) {
          canvas.begin(0.2F, 0.3F, 0.1F);
          scene->program.use();
          scene->program.set("alpha_is", frame < 10 ? 0 : frame < 17 ? 1 : frame < 24 ? 2 : 0);
          if (frame >= 24) canvas.gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
          scene->draw_box(scene->camera(frame));
          canvas.gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
          canvas.gl.Enable(GL_BLEND);
          canvas.gl.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
          tint->use();
          tint->set("clip_from_object", identity);
          scene->vertices.draw(std::array<Vector, 3>{Vector{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}});
        };
      }};
}

}  // namespace adversary::casters
