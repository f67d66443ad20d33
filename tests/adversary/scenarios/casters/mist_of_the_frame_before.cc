// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mist_of_the_frame_before() {
  return {
      .sentence =
          "Two framebuffer objects with depth textures take turns; in every second frame mist is blended over "
          "the image by the depth of the other one, which the frame before has written.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        const std::array<std::shared_ptr<Offscreen>, 2> targets{std::make_shared<Offscreen>(canvas, GL_RGBA8),
                                                                std::make_shared<Offscreen>(canvas, GL_RGBA8)};
        std::array<GLuint, 2> depths{};
        gl.GenTextures(2, depths.data());
        gl.ActiveTexture(GL_TEXTURE6);
        for (const std::size_t i : {0, 1}) {
          gl.BindTexture(GL_TEXTURE_2D, depths[i]);
          filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
          gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, canvas.width(), canvas.height(), 0,
                        GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
          gl.BindFramebuffer(GL_FRAMEBUFFER, targets[i]->framebuffer());
          gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths[i], 0);
        }
        auto mist = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
uniform sampler2D depth;
out vec4 colour;
void main() {
  float away = 0.1 / (1.0 - 0.99 * texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r);
  colour = vec4(0.7, 0.75, 0.8, clamp(0.6 * (away - 1.7), 0.0, 0.8));
}
)");
        return [&canvas, targets, depths, mist, scene = caster_scene(canvas)](int frame) {
          const Offscreen& target = *targets[static_cast<std::size_t>(frame % 2)];
          target.begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_box(scene->camera(frame));
          canvas.gl.Disable(GL_DEPTH_TEST);
          target.show();
          if (frame % 2 == 0) return;
          canvas.gl.ActiveTexture(GL_TEXTURE6);
          canvas.gl.BindTexture(GL_TEXTURE_2D, depths[0]);
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
