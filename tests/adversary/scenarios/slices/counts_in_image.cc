// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario counts_in_image() {
  return {.sentence = "Every fragment adds one to a texel of an image, which is read in every frame.",
          .expectation = Expectation::must_be_left,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(
                canvas, {.fragment = at_version(
                             430, slice_fragment_shader("layout(r32ui, binding = 2) uniform uimage2D counter;",
                                                        "  imageAtomicAdd(counter, ivec2(0), 1u);"))});
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
              GLuint fragments = 0;
              canvas.gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
              canvas.gl.ActiveTexture(GL_TEXTURE6);
              canvas.gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &fragments);
              canvas.note(std::to_string(fragments));
            };
          }};
}

}  // namespace adversary::slices
