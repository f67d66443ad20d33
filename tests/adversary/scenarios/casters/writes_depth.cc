// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario writes_depth() {
  return {
      .sentence =
          "The shader writes the depth of the first dense sample; triangles drawn afterwards are hidden by it.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform mat4 clip_from_object;",
                          .before = "  vec4 sum = vec4(0.0);\n  gl_FragDepth = 1.0;",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                                  "    if (value > 0.6 && gl_FragDepth == 1.0) {\n"
                                  "      vec4 clip = clip_from_object * vec4(here, 1.0);\n"
                                  "      gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;\n"
                                  "    }",
                          .after = "  shown = sum;"})});
        return [&canvas, opaque, scene](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.1F, 0.12F, 0.2F);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_box(camera);
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(
              std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 0.5F}});
        };
      }};
}

}  // namespace adversary::casters
