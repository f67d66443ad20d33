// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_discards_by_value() {
  return {.sentence =
              "Without blending, over stripes that move with every frame; in frames 10 to 19 a uniform has the "
              "shader discard rays without a large value, through which the stripes and a triangle drawn "
              "afterwards "
              "behind the box show.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto stripes = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
uniform float shift;
in vec3 at;
out vec4 colour;
void main() {
  float bright = step(0.5, fract(4.0 * at.x + shift));
  colour = vec4(0.9 * bright, 0.5 + 0.4 * at.y, 1.0 - bright, 1.0);
}
)");
            auto scene = caster_scene(
                canvas, {.fragment = caster_fragment_shader(
                             {.declarations = "uniform float least;",
                              .before = "  vec4 sum = vec4(0.0);\n  float largest = 0.0;",
                              .each = "    largest = max(largest, value);\n"
                                      "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                      "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                              .after = "  if (largest < least) discard;\n  shown = sum;"}),
                         .blending = Blending::off});
            return [&canvas, stripes, scene](int frame) {
              canvas.begin();
              canvas.gl.Disable(GL_BLEND);
              stripes->use();
              stripes->set("clip_from_object", identity);
              stripes->set("shift", 0.07F * static_cast<float>(frame));
              scene->vertices.draw(std::array<Vector, 3>{Vector{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}});
              canvas.gl.Enable(GL_DEPTH_TEST);
              scene->program.use();
              scene->program.set("least", frame / 10 == 1 ? 0.8F : 0.0F);
              scene->draw_box(scene->camera(frame));
              stripes->use();
              stripes->set("shift", 0.25F);
              scene->vertices.draw(std::array<Vector, 3>{
                  Vector{-0.7F, -0.9F, 0.999F}, {0.9F, -0.4F, 0.999F}, {0, 0.9F, 0.999F}});
              canvas.gl.Disable(GL_DEPTH_TEST);
            };
          }};
}

}  // namespace adversary::casters
