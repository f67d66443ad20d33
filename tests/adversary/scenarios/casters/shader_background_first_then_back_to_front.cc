// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// Runs from a back face towards the eye.
const std::string towards_the_eye = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform vec3 background;
in vec3 at;
out vec4 shown;
void main() {
  vec3 direction = normalize(eye - at);
  vec3 ends = (step(0.0, direction) - at) / direction;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec3 sum = background;
  for (int i = 0; i < count; ++i) {
    vec4 colour = texture(table, vec2(texture(volume, at + float(i) * step_length * direction).r, 0.5));
    sum = mix(sum, colour.rgb, colour.a);
  }
  shown = vec4(sum, 1.0);
}
)";

}  // namespace

Scenario shader_background_first_then_back_to_front() {
  return {
      .sentence =
          "Without blending, back faces: each ray begins with the background's colour, a uniform, and mixes "
          "in the samples from the far one to the near one; no alpha is kept, 1 is written. The background "
          "changes at frame 18.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {18},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = towards_the_eye});
        return [&canvas, scene](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.6F, 0.1F, 0.1F);
          canvas.gl.Disable(GL_BLEND);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          scene->program.use();
          scene->program.set("clip_from_object", camera.clip_from_object());
          scene->program.set("eye", camera.eye);
          scene->program.set("background", frame < 18 ? Vector{0.85F, 0.8F, 0.7F} : Vector{0.05F, 0.1F, 0.25F});
          scene->vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
