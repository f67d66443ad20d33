// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario focus_and_context() {
  return {
      .sentence =
          "Slices into a framebuffer object with a depth texture; a second pass blurs and greys the image the "
          "more, the farther its depth is from what is in focus.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);  // its image stays on unit 7
        GLuint depth = 0;
        gl.GenTextures(1, &depth);
        gl.ActiveTexture(GL_TEXTURE6);
        gl.BindTexture(GL_TEXTURE_2D, depth);
        filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
        gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, canvas.width(), canvas.height(), 0,
                      GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
        gl.BindFramebuffer(GL_FRAMEBUFFER, offscreen->framebuffer());
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
        auto lens = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
uniform sampler2D image;
uniform sampler2D depth;
out vec4 colour;
void main() {
  float away = 0.1 / (1.0 - 0.99 * texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r);
  float blur = clamp(1.5 * abs(away - 2.1), 0.0, 1.0);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 25; ++i) {
    vec2 at = gl_FragCoord.xy + 3.0 * blur * vec2(i % 5 - 2, i / 5 - 2);
    sum += texelFetch(image, clamp(ivec2(at), ivec2(0), textureSize(image, 0) - 1), 0).rgb / 25.0;
  }
  colour = vec4(mix(sum, vec3(dot(sum, vec3(0.33))), blur), 1.0);
}
)");
        return [&canvas, offscreen, lens, scene = slice_scene(canvas)](int frame) {
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_slices(scene->camera(frame));
          canvas.gl.Disable(GL_DEPTH_TEST);
          canvas.gl.Disable(GL_BLEND);
          canvas.begin();
          lens->use();
          lens->set("image", 7);
          lens->set("depth", 6);
          lens->set("clip_from_object", identity);
          scene->vertices.draw(std::array<Vector, 4>{Vector{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                               GL_TRIANGLE_STRIP);
        };
      }};
}

}  // namespace adversary::slices
