// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_hides_and_is_hidden() {
  return {
      .sentence =
          "Without blending, both faces of the box in one draw, tested against depth and written to it; the "
          "shader composes over grey blue with an alpha of 1. Stripes behind are hidden also where no sample "
          "shows anything, a triangle before the box stays, and one through the box, drawn after it, is seen "
          "outside of it only.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() {
  float stripe = step(0.5, fract(4.0 * (at.x + at.y)));
  colour = vec4(0.9, 0.2 + 0.6 * stripe, 0.1, 1.0);
}
)");
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "const vec3 background = vec3(0.55, 0.6, 0.7);",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = vec4(background * (1.0 - sum.a) + sum.rgb, 1.0);"})});
        return [&canvas, opaque, scene](int frame) {
          const Camera camera = scene->camera(frame);
          const auto draw_triangles = [&](const Matrix& clip_from_triangles,
                                          const std::vector<Vector>& corners) {
            opaque->use();
            opaque->set("clip_from_object", clip_from_triangles);
            scene->vertices.draw(corners);
          };
          const Matrix as_it_is{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
          canvas.begin(0.1F, 0.3F, 0.1F);
          canvas.gl.Disable(GL_BLEND);
          canvas.gl.Enable(GL_DEPTH_TEST);
          draw_triangles(as_it_is, {{-1, -1, 0.9999F}, {1, -1, 0.9999F}, {-1, 0.8F, 0.9999F}});
          draw_triangles(as_it_is, {{0, 0.1F, -0.9F}, {0.9F, 0.2F, -0.9F}, {0.4F, 0.9F, -0.9F}});
          scene->program.use();
          scene->program.set("clip_from_object", camera.clip_from_object());
          scene->program.set("eye", camera.eye);
          scene->vertices.draw(box_triangles());
          draw_triangles(camera.clip_from_object(),
                         {{-0.4F, 0.3F, 0.4F}, {1.4F, 0.4F, 0.6F}, {0.6F, 1.4F, 0.5F}});
        };
      }};
}

}  // namespace adversary::casters
