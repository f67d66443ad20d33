// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mipmapped_table_striped() {
  return {.sentence =
              "A sampler object filters the table by mipmaps. It is a ramp of greys, which looks alike in all "
              "levels. At frame 10 it gets stripes of eight texels, which its upper levels average.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            std::vector<Colour> ramp(256);
            std::vector<Colour> stripes(256);
            for (int i = 0; i < 256; ++i) {
              const auto grey = static_cast<std::uint8_t>(i);
              ramp[i] = {grey, grey, grey, 20};
              stripes[i] = i / 8 % 2 == 0 ? Colour{255, 40, 40, 60} : Colour{40, 40, 255, 2};
            }
            auto scene = caster_scene(canvas, {.table = ramp, .orbit = {.degrees_each_frame = 0}});
            canvas.gl.GenerateMipmap(GL_TEXTURE_2D);
            GLuint sampler = 0;
            canvas.gl.GenSamplers(1, &sampler);
            canvas.gl.SamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
              canvas.gl.SamplerParameteri(sampler, name, GL_CLAMP_TO_EDGE);
            canvas.gl.BindSampler(1, sampler);
            return [&canvas, scene, stripes](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame == 10) {
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        stripes.data());
                canvas.gl.GenerateMipmap(GL_TEXTURE_2D);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
