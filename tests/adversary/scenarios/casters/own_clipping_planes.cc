// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario own_clipping_planes() {
  return {
      .sentence =
          "A clipping plane, a number, a point and a normal, in an array of VTK's name and size, in a program "
          "without VTK's matrices. The camera stands still. From frame 10 on, the plane cuts.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(uniform float in_clippingPlanes[7];
bool clipped(vec3 p) {
  vec3 point = vec3(in_clippingPlanes[1], in_clippingPlanes[2], in_clippingPlanes[3]);
  vec3 normal = vec3(in_clippingPlanes[4], in_clippingPlanes[5], in_clippingPlanes[6]);
  return in_clippingPlanes[0] > 0.0 && dot(p - point, normal) < 0.0;
})",
                                                                   "    if (clipped(here)) continue;"),
                                           .orbit = {.degrees_each_frame = 0}});
        return [&canvas, scene](int frame) {
          const std::array<float, 7> plane{6, frame < 10 ? -1.0F : 0.5F, 0, 0, 1, 0, 0};
          scene->program.use();
          canvas.gl.Uniform1fv(scene->program.location("in_clippingPlanes"), 7, plane.data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
