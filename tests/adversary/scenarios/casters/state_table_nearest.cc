// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario state_table_nearest() {
  return {.sentence =
              "A table of five colours in a rectangle texture is interpolated until frame 10, and then no "
              "longer. Its texels and the camera stay.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster("uniform sampler2DRect rectangle;", R"(
    colour = texture(rectangle, vec2(5.0 * value, 0.5));)"),
                                               .orbit = {.degrees_each_frame = 0}});
            constexpr std::array<Colour, 5> table{Colour{200, 40, 40, 3},
                                                  {40, 60, 220, 30},
                                                  {230, 200, 40, 4},
                                                  {40, 200, 90, 28},
                                                  {220, 220, 230, 40}};
            GLuint rectangle = 0;
            canvas.gl.GenTextures(1, &rectangle);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_RECTANGLE, rectangle);
            canvas.gl.TexImage2D(GL_TEXTURE_RECTANGLE, 0, GL_RGBA8, 5, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                 table.data());
            scene->program.set("rectangle", 2);
            return [&canvas, scene](int frame) {
              const GLenum filter = frame < 10 ? GL_LINEAR : GL_NEAREST;
              canvas.gl.ActiveTexture(GL_TEXTURE2);
              if (frame == 0 || frame == 10) filter_linearly(canvas, GL_TEXTURE_RECTANGLE, filter);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
