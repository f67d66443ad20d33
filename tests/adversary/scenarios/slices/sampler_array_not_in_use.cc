// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario sampler_array_not_in_use() {
  return {.sentence =
              "A uniform chooses between the table and an array texture on unit 2. It always chooses the "
              "table.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene =
                slice_scene(canvas, {.fragment = slice_fragment_shader(
                                         "uniform sampler2DArray odd;\nuniform bool layered;\n",
                                         "if (layered) colour = texture(odd, vec3(value, 0.5, 1.0));")});
            GLuint layers = 0;
            canvas.gl.GenTextures(1, &layers);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_2D_ARRAY, layers);
            const std::array<GLubyte, 8> texels{0, 255, 0, 255, 255, 0, 0, 255};
            canvas.gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA8, 1, 1, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                 texels.data());
            filter_linearly(canvas, GL_TEXTURE_2D_ARRAY);
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("odd", 2);
              scene->program.set("layered", 0);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
