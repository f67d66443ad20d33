// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario marks_tested_against_last_frame() {
  return {
      .sentence =
          "Marks are drawn before the slices, tested against the depth that the frame before left; only then "
          "is depth cleared.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        offscreen->attach_depth(GL_DEPTH_COMPONENT24);
        gl.Clear(GL_DEPTH_BUFFER_BIT);
        auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(1.0, 0.9, 0.3 * at.x, 1.0); }
)");
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour.a *= 0.5;")});
        return [&canvas, offscreen, opaque, scene](int frame) {
          const Camera camera = scene->camera(frame);
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Enable(GL_DEPTH_TEST);
          canvas.gl.DepthMask(GL_FALSE);
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(
              std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 1.2F}});
          canvas.gl.DepthMask(GL_TRUE);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
          scene->draw_slices(camera);
          canvas.gl.Disable(GL_DEPTH_TEST);
          offscreen->show();
        };
      }};
}

}  // namespace adversary::slices
