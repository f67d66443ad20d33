// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string largest_of_at_least_one = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D noise;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

bool inside(vec3 p) {
  return p.x >= 0.0 && p.y >= 0.0 && p.z >= 0.0 && p.x <= 1.0 && p.y <= 1.0 && p.z <= 1.0;
}

void main() {
  vec3 direction = normalize(at - eye);
  float offset = texture(noise, gl_FragCoord.xy / 32.0).r;
  vec3 here = at + offset * step_length * direction;
  float largest = 0.0;
  do {
    largest = max(largest, texture(volume, here).r);
    here += step_length * direction;
  } while (inside(here));
  shown = texture(table, vec2(largest, 0.5));
}
)";

}  // namespace

Scenario late_first_always_maximum() {
  return {
      .sentence =
          "The largest value along the ray, whose first sample, later by noise, is always taken; steps are 8 "
          "texels long at first, 16 from frame 10 on and 26 from frame 20 on.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = largest_of_at_least_one,
                                           .grid = sampled(64, shells),
                                           .table = opaque_colours(),
                                           .orbit = {.azimuth = 205, .elevation = -24}});
        std::vector<std::uint8_t> noise;
        std::uint32_t state = 90125;
        for (int i = 0; i < 32 * 32; ++i) {
          state = state * 1664525U + 1013904223U;
          noise.push_back(static_cast<std::uint8_t>(state >> 24));
        }
        upload_mask_2d(canvas, 2, noise, 32);
        for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
          canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("noise", 2);
          scene->program.set("step_length", frame < 10 ? 0.125F : frame < 20 ? 0.25F : 0.4F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
