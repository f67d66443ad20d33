// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario vertices_count_in_image() {
  return {.sentence = "Every vertex adds one to a texel of an image, which is read in every frame.",
          .expectation = Expectation::must_be_left,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_object;
layout(r32ui, binding = 2) uniform uimage2D counter;
out vec3 at;
void main() {
  imageAtomicAdd(counter, ivec2(0), 1u);
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"});
            constexpr GLuint zero = 0;
            GLuint image = 0;
            canvas.gl.GenTextures(1, &image);
            canvas.gl.ActiveTexture(GL_TEXTURE6);
            canvas.gl.BindTexture(GL_TEXTURE_2D, image);
            filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, 1, 1, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
            canvas.gl.BindImageTexture(2, image, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
            return [&canvas, scene](int frame) {
              scene->draw(frame);
              GLuint vertices = 0;
              canvas.gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
              canvas.gl.ActiveTexture(GL_TEXTURE6);
              canvas.gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &vertices);
              canvas.note(std::to_string(vertices));
            };
          }};
}

}  // namespace adversary::slices
