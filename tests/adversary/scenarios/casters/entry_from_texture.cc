// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario entry_from_texture() {
  return {.sentence = "Back faces are drawn into a float texture first; rays end where it tells.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto back = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at, 1.0); }
)");
            GLuint ends = 0, framebuffer = 0;
            const Gl& gl = canvas.gl;
            gl.GenTextures(1, &ends);
            gl.ActiveTexture(GL_TEXTURE3);
            gl.BindTexture(GL_TEXTURE_2D, ends);
            filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
            gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, canvas.width(), canvas.height(), 0, GL_RGBA, GL_FLOAT,
                          nullptr);
            gl.GenFramebuffers(1, &framebuffer);
            gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
            gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, ends, 0);
            auto scene = caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D ends;
in vec3 at;
out vec4 shown;
void main() {
  vec3 way = texelFetch(ends, ivec2(gl_FragCoord.xy), 0).xyz - at;
  vec3 direction = normalize(way);
  int count = int(length(way) / 0.025) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec4 colour = texture(table, vec2(texture(volume, at + float(i) * 0.025 * direction).r, 0.5));
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
  }
  shown = sum;
}
)"});
            return [&canvas, back, framebuffer, scene](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
              canvas.gl.Disable(GL_BLEND);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_FRONT);
              back->use();
              back->set("clip_from_object", camera.clip_from_object());
              scene->vertices.draw(box_triangles());
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("ends", 3);
              scene->draw_box(camera);
            };
          }};
}

}  // namespace adversary::casters
