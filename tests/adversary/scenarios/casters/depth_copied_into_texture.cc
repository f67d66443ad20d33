// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario depth_copied_into_texture() {
  return {
      .sentence =
          "The box writes depth in the window, which glCopyTexSubImage2D takes into a texture; mist by that "
          "depth is blended over the image.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        GLuint depth = 0;
        gl.GenTextures(1, &depth);
        gl.ActiveTexture(GL_TEXTURE6);
        gl.BindTexture(GL_TEXTURE_2D, depth);
        filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
        gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, canvas.width(), canvas.height(), 0,
                      GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
        auto mist = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
uniform sampler2D depth;
out vec4 colour;
void main() {
  float away = 0.1 / (1.0 - 0.99 * texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r);
  colour = vec4(0.7, 0.75, 0.8, clamp(0.6 * (away - 1.7), 0.0, 0.8));
}
)");
        return [&canvas, mist, scene = caster_scene(canvas)](int frame) {
          canvas.begin(0.1F, 0.12F, 0.2F);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_box(scene->camera(frame));
          canvas.gl.Disable(GL_DEPTH_TEST);
          canvas.gl.ActiveTexture(GL_TEXTURE6);
          canvas.gl.CopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, canvas.width(), canvas.height());
          set_blending(canvas.gl, Blending::over);
          mist->use();
          mist->set("depth", 6);
          mist->set("clip_from_object", identity);
          scene->vertices.draw(std::array<Vector, 4>{Vector{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                               GL_TRIANGLE_STRIP);
        };
      }};
}

}  // namespace adversary::casters
