// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario glsl_450_bindings() {
  return {.sentence = "GLSL 4.50 with explicit locations and bindings.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.fragment = R"(#version 450 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D table;
layout(location = 0) in vec3 at;
layout(location = 0) out vec4 colour;
void main() { colour = texture(table, vec2(texture(volume, at).r, 0.5)); }
)",
                                                 .vertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 5) uniform mat4 clip_from_object;
layout(location = 0) out vec3 at;
void main() {
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
