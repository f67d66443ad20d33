// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_volume_defined_anew() {
  return {.sentence =
              "A volume of a dozen values in bytes, spread over the table, so that it shows how coarsely the "
              "driver interpolates bytes. At frame 12 its texture is deleted, and another volume of 16 bits is "
              "defined under its name.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", R"(
  colour = texture(table, vec2(20.0 * value, 0.5));)"),
                                              .grid = scaled(sampled(48, shells), 0.05F),
                                              .slices = 24});
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              if (frame == 12) {
                canvas.gl.DeleteTextures(1, &scene->volume);
                canvas.gl.BindTexture(GL_TEXTURE_3D, scene->volume);
                filter_linearly(canvas, GL_TEXTURE_3D);
                canvas.gl.TexImage3D(GL_TEXTURE_3D, 0, canvas.exact() ? GL_R32F : GL_R16, 48, 48, 48, 0, GL_RED,
                                     GL_FLOAT, nullptr);
                replace_texels(canvas, scaled(sampled(48, waves), 0.05F), {.texel = Texel::unsigned16});
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
