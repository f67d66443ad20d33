// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string pieces_by_their_length = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D noise;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 planes = (step(0.0, dir) - at) / dir;
  float end = min(planes.x, min(planes.y, planes.z));
  float begin = 0.0;
  float piece = min(end, step_length * (0.5 + 0.5 * texture(noise, gl_FragCoord.xy / 64.0).r));
  vec4 sum = vec4(0.0);
  do {
    vec4 c = texture(table, vec2(texture(volume, at + (begin + 0.5 * piece) * dir).r, 0.5));
    c.a = 1.0 - pow(1.0 - c.a, piece / 0.02);
    sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    begin += piece;
    piece = min(step_length, end - begin);
  } while (begin < end);
  shown = sum;
}
)";

}  // namespace

Scenario late_last_piece_weighted() {
  return {
      .sentence =
          "Rays are cut into pieces, the first shorter by noise and the last by the box; each is sampled in "
          "its "
          "middle, and its opacity corrected for its own length. Steps are 7 texels long, 16 in frames 6 to 12 "
          "and 20 to 25.",
      .expectation = Expectation::either,
      .key_frames = {6, 13, 20, 26},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = pieces_by_their_length,
                                           .grid = sampled(64, 60, 56, shells),
                                           .table = other_colours(),
                                           .orbit = {.azimuth = 250, .elevation = 30}});
        std::vector<std::uint8_t> noise;
        std::uint32_t state = 16180;
        for (int i = 0; i < 64 * 64; ++i) {
          state = state * 1664525U + 1013904223U;
          noise.push_back(static_cast<std::uint8_t>(state >> 24));
        }
        upload_mask_2d(canvas, 2, noise, 64);
        for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
          canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
        return [scene](int frame) {
          const bool dragged = (frame >= 6 && frame < 13) || (frame >= 20 && frame < 26);
          scene->program.use();
          scene->program.set("noise", 2);
          scene->program.set("step_length", dragged ? 0.26F : 0.11F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
