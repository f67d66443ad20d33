// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario smooth_in() {
  return {.sentence =
              "The fragment shader declares its coordinate as `smooth in`, the vertex shader as `smooth out`.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            std::string vertex = slice_vertex_shader, fragment = slice_fragment_shader();
            vertex.replace(vertex.find("out vec3 at"), 3, "smooth out");
            fragment.replace(fragment.find("in vec3 at"), 2, "smooth in");
            return [scene = slice_scene(canvas, {.fragment = fragment, .vertex = vertex})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
