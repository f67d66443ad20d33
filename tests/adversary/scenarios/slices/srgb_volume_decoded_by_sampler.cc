// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario srgb_volume_decoded_by_sampler() {
  return {.sentence =
              "The colours per voxel are sRGB. The sampler object of their unit does not decode them until "
              "frame 20.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene =
                slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour = texture(volume, at);")});
            const Grid grid = coloured(sampled(48, waves));
            std::vector<std::uint8_t> texels;
            for (const float value : grid.values)
              texels.push_back(static_cast<std::uint8_t>(std::lround(255 * value)));
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            canvas.gl.TexImage3D(GL_TEXTURE_3D, 0, GL_SRGB8_ALPHA8, grid.x, grid.y, grid.z, 0, GL_RGBA,
                                 GL_UNSIGNED_BYTE, texels.data());
            GLuint sampler = 0;
            canvas.gl.GenSamplers(1, &sampler);
            for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
              canvas.gl.SamplerParameteri(sampler, name, GL_LINEAR);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
              canvas.gl.SamplerParameteri(sampler, name, GL_CLAMP_TO_EDGE);
            canvas.gl.BindSampler(0, sampler);
            return [&canvas, scene, sampler](int frame) {
              if (frame == 0 || frame == 20)
                canvas.gl.SamplerParameteri(sampler, GL_TEXTURE_SRGB_DECODE_EXT,
                                            frame < 20 ? GL_SKIP_DECODE_EXT : GL_DECODE_EXT);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
