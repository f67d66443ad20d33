// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario srgb_table_no_longer_decoded() {
  return {.sentence =
              "The table's colours are sRGB, and its unit has a sampler object. From frame 10 on, this looks "
              "them up without decoding them. The camera stays.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.orbit = {.degrees_each_frame = 0}});
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                 soft_colours().data());
            GLuint sampler = 0;
            canvas.gl.GenSamplers(1, &sampler);
            for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
              canvas.gl.SamplerParameteri(sampler, name, GL_LINEAR);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
              canvas.gl.SamplerParameteri(sampler, name, GL_CLAMP_TO_EDGE);
            canvas.gl.BindSampler(1, sampler);
            return [&canvas, scene, sampler](int frame) {
              if (frame == 10)
                canvas.gl.SamplerParameteri(sampler, GL_TEXTURE_SRGB_DECODE_EXT, GL_SKIP_DECODE_EXT);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
