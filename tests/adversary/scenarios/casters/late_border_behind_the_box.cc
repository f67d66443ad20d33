// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string sampled_before_asked = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform sampler2D noise;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 pos = at + dir * (step_length * texture(noise, gl_FragCoord.xy / 64.0).r);
  vec4 dst = vec4(0.0);
  do {
    vec4 src = texture(table, vec2(texture(volume, pos).r, 0.5));
    src.a = 1.0 - pow(1.0 - src.a, step_length / 0.02);
    dst += (1.0 - dst.a) * vec4(src.rgb * src.a, src.a);
    pos += dir * step_length;
  } while (pos == clamp(pos, 0.0, 1.0));
  shown = dst;
}
)";

}  // namespace

Scenario late_border_behind_the_box() {
  return {.sentence =
              "The volume's texture has a border of value 0.95, which first samples show that noise puts "
              "behind the "
              "box; steps are 9 texels long, 22 in frames 10 to 19.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = sampled_before_asked,
                                               .grid = scaled(sampled(64, waves), 0.7F, 0.1F),
                                               .orbit = {.azimuth = 330, .elevation = 26}});
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            canvas.gl.BindTexture(GL_TEXTURE_3D, scene->volume);
            const std::array<float, 4> border{0.95F, 0, 0, 1};
            canvas.gl.TexParameterfv(GL_TEXTURE_3D, GL_TEXTURE_BORDER_COLOR, border.data());
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
              canvas.gl.TexParameteri(GL_TEXTURE_3D, name, GL_CLAMP_TO_BORDER);
            std::vector<std::uint8_t> noise;
            std::uint32_t state = 31337;
            for (int i = 0; i < 64 * 64; ++i) {
              state = state * 1664525U + 1013904223U;
              noise.push_back(static_cast<std::uint8_t>(state >> 24));
            }
            upload_mask_2d(canvas, 2, noise, 64);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
              canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("noise", 2);
              scene->program.set("step_length", frame >= 10 && frame < 20 ? 0.34F : 0.14F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
