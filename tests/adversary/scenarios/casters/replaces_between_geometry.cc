// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_between_geometry() {
  return {
      .sentence =
          "Without blending, triangles before and after the box, all tested against depth; from frame 8 on the "
          "box does not write depth, from frame 14 on it is not tested and so writes none, and from frame 20 "
          "on "
          "another shader under the same name writes the depth of the first dense sample.",
      .expectation = Expectation::either,
      .key_frames = {8, 14, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 0.8, at.y, 1.0); }
)");
        const std::string with_depth = caster_fragment_shader(
            {.declarations = "uniform mat4 clip_from_object;",
             .before = "  vec4 sum = vec4(0.0);\n  gl_FragDepth = 1.0;",
             .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                     "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                     "    if (value > 0.6 && gl_FragDepth == 1.0) {\n"
                     "      vec4 clip = clip_from_object * vec4(here, 1.0);\n"
                     "      gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;\n"
                     "    }",
             .after = "  shown = sum;"});
        return [&canvas, opaque, with_depth,
                scene = caster_scene(canvas, {.blending = Blending::off})](int frame) {
          const Camera camera = scene->camera(frame);
          const auto draw_triangles = [&](const std::vector<Vector>& corners) {
            canvas.gl.Disable(GL_BLEND);
            canvas.gl.Enable(GL_DEPTH_TEST);
            opaque->use();
            opaque->set("clip_from_object", camera.clip_from_object());
            scene->vertices.draw(corners);
          };
          if (frame == 20) {
            scene->program.link({{GL_VERTEX_SHADER, caster_vertex_shader}, {GL_FRAGMENT_SHADER, with_depth}});
            scene->program.use();
            scene->program.set("volume", 0);
            scene->program.set("table", 1);
            scene->program.set("step_length", scene->settings.step_length);
          }
          canvas.begin(0.5F, 0.2F, 0.2F);
          draw_triangles({{0.1F, 0, 0.4F},
                          {0.9F, 0.1F, 0.6F},
                          {0.5F, 0.7F, 0.5F},
                          {0.9F, 0.6F, 1.1F},
                          {0.6F, 1, 1.2F},
                          {1.2F, 1, 0.9F}});
          canvas.gl.DepthMask(frame >= 8 && frame < 14 ? GL_FALSE : GL_TRUE);
          if (frame >= 14 && frame < 20) canvas.gl.Disable(GL_DEPTH_TEST);
          scene->draw_box(camera);
          canvas.gl.DepthMask(GL_TRUE);
          draw_triangles({{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 0.5F}});
        };
      }};
}

}  // namespace adversary::casters
