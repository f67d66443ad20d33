// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario sampler_object() {
  return {.sentence = "A sampler object without interpolation is bound from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            GLuint sampler = 0;
            canvas.gl.GenSamplers(1, &sampler);
            for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
              canvas.gl.SamplerParameteri(sampler, name, GL_NEAREST);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
              canvas.gl.SamplerParameteri(sampler, name, GL_CLAMP_TO_EDGE);
            return [&canvas, sampler, scene = slice_scene(canvas, {.grid = sampled(24, waves)})](int frame) {
              if (frame == 10) canvas.gl.BindSampler(0, sampler);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
