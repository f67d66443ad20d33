// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario texture_stack() {
  return {.sentence = "Fixed function: a stack of 2-D textures, one quad each.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            constexpr int edge = 48;
            const Grid grid = coloured(sampled(edge, waves));
            const Gl& gl = canvas.gl;
            std::vector<GLuint> textures(edge);
            gl.GenTextures(edge, textures.data());
            gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
            for (int z = 0; z < edge; ++z) {
              const Grid slice = part_of(grid, 0, 0, z, edge, edge, 1);
              gl.BindTexture(GL_TEXTURE_2D, textures[static_cast<std::size_t>(z)]);
              filter_linearly(canvas, GL_TEXTURE_2D);
              gl.TexImage2D(GL_TEXTURE_2D, 0, canvas.exact() ? GL_RGBA32F : GL_RGBA8, edge, edge, 0, GL_RGBA,
                            GL_FLOAT, slice.values.data());
            }
            return [&canvas, textures](int frame) {
              const Gl& gl = canvas.gl;
              begin_old_frame(canvas, old_camera(canvas, frame, {.azimuth = 10}));
              gl.Enable(GL_TEXTURE_2D);
              gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
              set_blending(gl, Blending::over);
              for (std::size_t z = 0; z < textures.size(); ++z) {
                gl.BindTexture(GL_TEXTURE_2D, textures[z]);
                gl.Begin(GL_QUADS);
                for (const auto& [x, y] : {std::array{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
                  gl.TexCoord2f(x, y);
                  gl.Vertex3f(x, y, (static_cast<float>(z) + 0.5F) / static_cast<float>(textures.size()));
                }
                gl.End();
              }
            };
          }};
}

}  // namespace adversary::slices
