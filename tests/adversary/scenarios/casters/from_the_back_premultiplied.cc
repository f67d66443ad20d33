// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string from_back_face = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;
void main() {
  vec3 back = normalize(eye - at);
  vec3 planes = (step(0.0, back) - at) / back;
  float chord = min(planes.x, min(planes.y, planes.z));
  int count = int(chord / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float value = texture(volume, at + float(i) * step_length * back).r;
    vec4 colour = texture(table, vec2(value, 0.5));
    sum = vec4(colour.rgb * colour.a, colour.a) + (1.0 - colour.a) * sum;
  }
  shown = sum;
}
)";

}  // namespace

Scenario from_the_back_premultiplied() {
  return {
      .sentence =
          "Only back faces are drawn; rays run from them to the eye, each sample is put over the ones "
          "before, and the premultiplied sum is blended with ONE, ONE_MINUS_SRC_ALPHA over a dark red window.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = from_back_face});
        return [&canvas, scene](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.35F, 0.08F, 0.1F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          scene->program.use();
          scene->program.set("clip_from_object", camera.clip_from_object());
          scene->program.set("eye", camera.eye);
          scene->vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
