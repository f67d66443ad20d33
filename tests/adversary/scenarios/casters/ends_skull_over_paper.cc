// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string ends_before_adding = R"(#version 400 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform vec3 paper;
in vec3 at;
out vec4 shown;

const float kOpaque = 0.975;

void main() {
  vec3 ray = normalize(at - eye);
  vec3 planes = (step(0.0, ray) - at) / ray;
  float end = min(planes.x, min(planes.y, planes.z));
  vec3 colour = vec3(0.0);
  float alpha = 0.0;
  for (float t = 0.5 * step_length; t < end; t += step_length) {
    float value = texture(volume, at + t * ray).r;
    vec4 c = texture(table, vec2(value, 0.5));
    if (alpha > kOpaque) break;
    float weight = (1.0 - alpha) * c.a;
    colour += weight * c.rgb;
    alpha += weight;
  }
  shown = vec4(colour + (1.0 - alpha) * paper, 1.0);
}
)";

}  // namespace

Scenario ends_skull_over_paper() {
  return {.sentence =
              "A skull of 52 x 44 x 48 half floats over a paper that the shader adds, without blending, GLSL "
              "4.00; whether alpha has passed 0.975 is looked at between fetching a sample and adding it. "
              "At frame 15 the table gets denser.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            const Field skull = [](float x, float y, float z) {
              const float a = (x - 0.5F) / 0.42F, b = (y - 0.53F) / 0.45F, c = (z - 0.48F) / 0.4F;
              const float radius = std::sqrt(a * a + b * b + c * c);
              const float bone = std::exp(-40 * (radius - 0.85F) * (radius - 0.85F));
              const float brain = radius < 0.8F ? 0.12F * std::sin(20 * x) * std::sin(18 * y + 10 * z) : 0.0F;
              const float a1 = x - 0.34F, a2 = x - 0.66F, b1 = y - 0.55F, c1 = z - 0.88F;
              const float eyes =
                  std::exp(-60 * (a1 * a1 + b1 * b1 + c1 * c1)) + std::exp(-60 * (a2 * a2 + b1 * b1 + c1 * c1));
              return std::clamp(0.15F + 0.7F * bone + brain - 0.6F * eyes, 0.0F, 1.0F);
            };
            const auto table_of = [](float denser) {
              std::vector<Colour> table;
              for (int i = 0; i < 256; ++i) {
                const float at = static_cast<float>(i) / 255;
                const float bone = std::clamp((at - 0.35F) / 0.4F, 0.0F, 1.0F);
                table.push_back({static_cast<std::uint8_t>(180 + 60 * bone),
                                 static_cast<std::uint8_t>(60 + 150 * bone),
                                 static_cast<std::uint8_t>(70 + 60 * at + 60 * bone),
                                 static_cast<std::uint8_t>(std::lround(denser * (3 + 60 * bone)))});
              }
              return table;
            };
            auto scene = caster_scene(
                canvas,
                {.fragment = ends_before_adding,
                 .grid = sampled(52, 44, 48, skull),
                 .format = {.texel = Texel::half},
                 .table = table_of(1),
                 .blending = Blending::off,
                 .step_length = 0.018F,
                 .orbit = {.azimuth = -25, .elevation = 10, .distance = 2.4F, .degrees_each_frame = 1.8F},
                 .background = {0.2F, 0.3F, 0.6F, 1}});
            return [scene, table_of](int frame) {
              if (frame == 15) {
                const auto colours = table_of(1.8F);
                scene->canvas.gl.ActiveTexture(GL_TEXTURE1);
                scene->canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                               colours.data());
              }
              scene->program.use();
              scene->program.set("paper", Vector{0.2F, 0.3F, 0.6F});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
