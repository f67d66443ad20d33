// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario centroid_in() {
  return {
      .sentence =
          "The fragment shader declares its coordinate as `centroid in`, the vertex shader as `centroid out`.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        std::string vertex = caster_vertex_shader, fragment = over_caster();
        vertex.replace(vertex.find("out vec3 at"), 3, "centroid out");
        fragment.replace(fragment.find("in vec3 at"), 2, "centroid in");
        return [scene = caster_scene(canvas, {.fragment = fragment, .vertex = vertex})](int frame) {
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
