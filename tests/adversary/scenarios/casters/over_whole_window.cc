// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario over_whole_window() {
  return {.sentence = "Two triangles over the whole window; the shader finds where rays meet the box.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye, forward, right, up;
in vec3 at;
out vec4 shown;
void main() {
  vec3 direction = normalize(forward + at.x * right + at.y * up);
  vec3 a = -eye / direction, b = (1.0 - eye) / direction;
  vec3 near = min(a, b), far = max(a, b);
  float begin = max(near.x, max(near.y, near.z)), end = min(far.x, min(far.y, far.z));
  vec4 sum = vec4(0.0);
  for (float gone = begin; gone < end; gone += 0.025) {
    vec4 colour = texture(table, vec2(texture(volume, eye + gone * direction).r, 0.5));
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
  }
  shown = sum;
}
)"});
            return [&canvas, scene](int frame) {
              const Camera camera = scene->camera(frame);
              const Vector right = normalized(cross(camera.forward, {0, 1, 0}));
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", identity);
              scene->program.set("eye", camera.eye);
              scene->program.set("forward", camera.forward);
              scene->program.set("right", 0.268F * right);
              scene->program.set("up", 0.268F * cross(right, camera.forward));
              set_blending(canvas.gl, Blending::premultiplied_over);
              scene->vertices.draw(std::array<Vector, 6>{
                  Vector{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
            };
          }};
}

}  // namespace adversary::casters
