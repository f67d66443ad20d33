// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_attribute_zero() {
  return {.sentence =
              "One quad for each slice: its corners come from gl_VertexID, its place from glVertexAttrib1f(0, "
              "z), without an array. From frame 10 on a program tints by the place.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string vertex = R"(#version 330 core
layout(location = 0) in float place;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = vec3(gl_VertexID & 1, gl_VertexID >> 1, place);
  gl_Position = clip_from_object * vec4(at, 1.0);
}
)";
            const Orbit orbit{.azimuth = 10};
            auto plain = slice_scene(canvas, {.vertex = vertex, .orbit = orbit});
            auto tinted = std::make_shared<GlslProgram>(
                canvas, vertex, slice_fragment_shader("", "  colour.rgb = mix(colour.rgb, at, 0.7);"));
            tinted->use();
            tinted->set("volume", 0);
            tinted->set("table", 1);
            GLuint no_arrays = 0;
            canvas.gl.GenVertexArrays(1, &no_arrays);
            canvas.gl.BindVertexArray(no_arrays);
            return [&canvas, plain, tinted](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              const GlslProgram& program = frame < 10 ? plain->program : *tinted;
              program.use();
              program.set("clip_from_object", plain->camera(frame).clip_from_object());
              set_blending(canvas.gl, Blending::over);
              for (int i = 0; i < 48; ++i) {
                canvas.gl.VertexAttrib1f(0, (static_cast<float>(i) + 0.5F) / 48);
                canvas.gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
              }
            };
          }};
}

}  // namespace adversary::slices
