// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clipping_planes_as_tint() {
  return {
      .sentence =
          "All uniforms by which VTK's clipping is known, with the number of planes 0. The numbers behind it "
          "are a tint, which is another from frame 10 on. The camera stands still.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(uniform float in_clippingPlanes[7];
uniform mat4 in_textureDatasetMatrix[1];
uniform mat4 in_volumeMatrix[1];
bool clipped(vec3 p) {
  return in_clippingPlanes[0] > 0.0 && (in_volumeMatrix[0] * in_textureDatasetMatrix[0] * vec4(p, 1.0)).x < 0.5;
})",
                                                                   R"(    if (clipped(here)) continue;
    colour.rgb *= vec3(in_clippingPlanes[1], in_clippingPlanes[2], in_clippingPlanes[3]);)"),
                                           .orbit = {.degrees_each_frame = 0}});
        return [&canvas, scene](int frame) {
          const float green = frame < 10 ? 1.0F : 0.3F;
          const std::array<float, 7> planes{0, 1, green, 1, 0, 0, 0};
          scene->program.use();
          scene->program.set("in_textureDatasetMatrix[0]", identity);
          scene->program.set("in_volumeMatrix[0]", identity);
          canvas.gl.Uniform1fv(scene->program.location("in_clippingPlanes"), 7, planes.data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
