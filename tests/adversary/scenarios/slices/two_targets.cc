// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario two_targets() {
  return {
      .sentence =
          "Two outputs at once into a framebuffer object; the window shows the second, the samples' values.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(
                                              "out vec4 values;", "  values = vec4(vec3(value), 0.1);")});
        GLuint first = 0;
        canvas.gl.GenRenderbuffers(1, &first);
        canvas.gl.BindRenderbuffer(GL_RENDERBUFFER, first);
        canvas.gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, canvas.width(), canvas.height());
        canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, offscreen->framebuffer());
        canvas.gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_RENDERBUFFER, first);
        constexpr std::array<GLenum, 2> buffers{GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT0};
        canvas.gl.DrawBuffers(2, buffers.data());
        scene->program.bind_outputs({"colour", "values"});
        scene->program.link(
            {{GL_VERTEX_SHADER, scene->settings.vertex}, {GL_FRAGMENT_SHADER, scene->settings.fragment}});
        scene->program.use();
        scene->program.set("volume", 0);
        scene->program.set("table", 1);
        return [offscreen, scene](int frame) {
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          scene->draw_slices(scene->camera(frame));
          offscreen->show();
        };
      }};
}

}  // namespace adversary::slices
