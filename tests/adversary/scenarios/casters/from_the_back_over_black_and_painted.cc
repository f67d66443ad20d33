// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// Keeps the light alone: what is behind the volume is black.
const std::string light_towards_eye = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;
void main() {
  vec3 towards_eye = normalize(eye - at);
  vec3 planes = (step(0.0, towards_eye) - at) / towards_eye;
  int last = int(min(planes.x, min(planes.y, planes.z)) / step_length);
  vec3 place = at;
  vec3 light = vec3(0.0);
  for (int i = 0; i <= last; ++i) {
    vec4 colour = texture(table, vec2(texture(volume, place).r, 0.5));
    light = light * (1.0 - colour.a) + colour.rgb * colour.a;
    place += step_length * towards_eye;
  }
  shown = vec4(light, 1.0);
}
)";

constexpr int edge = 48;

}  // namespace

Scenario from_the_back_over_black_and_painted() {
  return {
      .sentence =
          "Back faces, from the far sample to the near one over black, with an alpha of 1, blended by the "
          "alpha "
          "in a light window. The user paints into the volume: a box of it is replaced at frame 9, another at "
          "frame 19.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {9, 19},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = light_towards_eye});
        return [&canvas, scene](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE0);
          if (frame == 9)
            replace_texels(canvas, part_of(sampled(edge, shells), 4, 6, 8, 24, 24, 24), scene->settings.format,
                           4, 6, 8);
          if (frame == 19)
            replace_texels(canvas, scaled(part_of(sampled(edge, waves), 20, 18, 10, 24, 28, 30), -1, 1),
                           scene->settings.format, 20, 18, 10);
          const Camera camera = scene->camera(frame);
          canvas.begin(0.85F, 0.87F, 0.9F);
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
