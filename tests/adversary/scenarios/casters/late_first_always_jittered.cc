// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string sampled_at_least_once = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D noise;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 delta = dir * step_length;
  vec3 pos = at + delta * texture(noise, gl_FragCoord.xy / 64.0).r;
  vec4 dst = vec4(0.0);
  do {
    float value = texture(volume, pos).r;
    vec4 src = texture(table, vec2(value, 0.5));
    src.a = 1.0 - pow(1.0 - src.a, step_length / 0.02);
    src.rgb *= src.a;
    dst += (1.0 - dst.a) * src;
    pos += delta;
  } while (all(greaterThanEqual(pos, vec3(0.0))) && all(lessThanEqual(pos, vec3(1.0))));
  shown = dst;
}
)";

}  // namespace

Scenario late_first_always_jittered() {
  return {
      .sentence =
          "Every ray takes a sample, up to a step behind its entry by a texture of noise, before it is asked "
          "whether it is still in the box; steps are 6 texels long, 19 in frames 8 to 15 and 23 to 29. "
          "Opacities are corrected for them.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {8, 16, 23},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = sampled_at_least_once,
                                           .grid = sampled(64, waves),
                                           .orbit = {.azimuth = 40, .elevation = 28}});
        std::vector<std::uint8_t> noise;
        std::uint32_t state = 4711;
        for (int i = 0; i < 64 * 64; ++i) {
          state = state * 1664525U + 1013904223U;
          noise.push_back(static_cast<std::uint8_t>(state >> 24));
        }
        upload_mask_2d(canvas, 2, noise, 64);
        for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
          canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
        return [scene](int frame) {
          const bool dragged = (frame >= 8 && frame < 16) || frame >= 23;
          scene->program.use();
          scene->program.set("noise", 2);
          scene->program.set("step_length", dragged ? 0.3F : 0.1F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
