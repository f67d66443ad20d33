// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario computed_texels() {
  return {.sentence = "A compute shader writes into the volume at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto compute = std::make_shared<GlslProgram>(canvas, std::vector<ShaderText>{{GL_COMPUTE_SHADER,
                                                                                          R"(#version 430 core
layout(local_size_x = 8, local_size_y = 8, local_size_z = 8) in;
layout(binding = 0) writeonly uniform image3D volume;
void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if ((texel.x / 6 + texel.y / 6 + texel.z / 6) % 2 == 0) imageStore(volume, texel, vec4(0.85));
}
)"}});
            return [&canvas, compute, scene = slice_scene(canvas)](int frame) {
              if (frame == 10) {
                compute->use();
                canvas.gl.BindImageTexture(0, scene->volume, 0, GL_TRUE, 0, GL_WRITE_ONLY,
                                           canvas.exact() ? GL_R32F : GL_R8);
                canvas.gl.DispatchCompute(6, 6, 6);
                canvas.gl.MemoryBarrier(GL_ALL_BARRIER_BITS);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
