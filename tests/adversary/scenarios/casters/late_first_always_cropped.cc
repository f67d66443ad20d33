// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string from_low_to_high = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D noise;
uniform vec3 eye;
uniform vec3 low;
uniform vec3 high;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 a = (low - eye) / dir;
  vec3 b = (high - eye) / dir;
  vec3 nearer = min(a, b);
  vec3 farther = max(a, b);
  float enter = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
  float leave = min(farther.x, min(farther.y, farther.z));
  if (enter >= leave) discard;
  float t = enter + step_length * texture(noise, gl_FragCoord.xy / 32.0).r;
  vec4 sum = vec4(0.0);
  do {
    vec4 c = texture(table, vec2(texture(volume, eye + t * dir).r, 0.5));
    c.a = 1.0 - pow(1.0 - c.a, step_length / 0.02);
    sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    t += step_length;
  } while (t < leave);
  shown = sum;
}
)";

}  // namespace

Scenario late_first_always_cropped() {
  return {
      .sentence =
          "Rays lead through a part of the volume that two uniforms tell, their first sample, later by noise, "
          "always taken; the user drags the part's upper side in frames 8 to 15, with steps of 18 texels "
          "instead "
          "of 6.",
      .expectation = Expectation::either,
      .key_frames = {8, 9, 10, 11, 12, 13, 14, 15, 16},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = from_low_to_high,
                                           .grid = sampled(64, waves),
                                           .orbit = {.azimuth = 15, .elevation = 22}});
        std::vector<std::uint8_t> noise;
        std::uint32_t state = 271828;
        for (int i = 0; i < 32 * 32; ++i) {
          state = state * 1664525U + 1013904223U;
          noise.push_back(static_cast<std::uint8_t>(state >> 24));
        }
        upload_mask_2d(canvas, 2, noise, 32);
        for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
          canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
        return [scene](int frame) {
          const float dragged = 0.04F * static_cast<float>(std::clamp(frame - 7, 0, 8));
          scene->program.use();
          scene->program.set("noise", 2);
          scene->program.set("low", Vector{0.1F, 0.05F, 0.15F});
          scene->program.set("high", Vector{0.9F, 0.95F - dragged, 0.85F});
          scene->program.set("step_length", frame >= 8 && frame < 16 ? 0.28F : 0.1F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
