// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// Each sample stands for the middle of its piece of the ray; pieces are counted from the back face.
const std::string middles_of_pieces = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;
void main() {
  vec3 towards_eye = normalize(eye - at);
  vec3 planes = (step(0.0, towards_eye) - at) / towards_eye;
  int pieces = int(min(planes.x, min(planes.y, planes.z)) / step_length + 0.5);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < pieces; ++i) {
    vec3 middle = at + (float(i) + 0.5) * step_length * towards_eye;
    vec4 colour = texture(table, vec2(texture(volume, middle).r, 0.5));
    sum.rgb = mix(sum.rgb, colour.rgb, colour.a);
    sum.a = mix(sum.a, 1.0, colour.a);
  }
  shown = vec4(sum.rgb / max(sum.a, 1e-6), sum.a);
}
)";

}  // namespace

Scenario from_the_back_by_half_a_step() {
  return {
      .sentence =
          "Back faces; the first sample is half a step before the ray's exit, the others follow towards the "
          "eye. The sum is divided by its alpha and blended by it. Other colours come at frame 14.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {14},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = middles_of_pieces, .step_length = 0.04F});
        return [&canvas, scene](int frame) {
          if (frame == 14) {
            const auto colours = other_colours();
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          const Camera camera = scene->camera(frame);
          canvas.begin(0.1F, 0.3F, 0.25F);
          set_blending(canvas.gl, Blending::over);
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
