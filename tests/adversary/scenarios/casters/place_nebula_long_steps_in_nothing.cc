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

const std::string doubled_where_transparent = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 planes = (step(0.0, dir) - at) / dir;
  float tmax = min(planes.x, min(planes.y, planes.z));
  float dt = step_length;
  vec4 acc = vec4(0.0);
  for (float t = 0.5 * step_length; t < tmax; t += dt) {
    vec4 c = texture(table, vec2(texture(volume, at + t * dir).r, 0.5));
    // nothing here: look again farther away
    dt = c.a < 0.004 ? 2.0 * step_length : step_length;
    acc.rgb += (1.0 - acc.a) * c.a * c.rgb;
    acc.a += (1.0 - acc.a) * c.a;
    if (acc.a >= 0.985) break;
  }
  shown = acc;
}
)";

std::vector<Colour> colours_from(float least) {
  std::vector<Colour> colours;
  for (int i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) / 255;
    const float visible = v < least ? 0.0F : 5 + 55 * v * v;
    colours.push_back({static_cast<std::uint8_t>(90 + 150 * v), static_cast<std::uint8_t>(60 + 80 * v * v),
                       static_cast<std::uint8_t>(220 - 110 * v),
                       static_cast<std::uint8_t>(std::lround(visible))});
  }
  return colours;
}

}  // namespace

Scenario place_nebula_long_steps_in_nothing() {
  return {.sentence =
              "A nebula of 56 floats an edge whose steps are doubled behind a sample of no opacity. Its table "
              "shows "
              "all values until frame 11, then none below 0.45, from frame 22 on none below 0.3.",
          .expectation = Expectation::either,
          .key_frames = {11, 22},
          .start = [](Canvas& canvas) -> DrawFrame {
            const Field nebula = [](float x, float y, float z) {
              const float warp = std::sin(7 * y + 3 * z), cloud = std::sin(10 * x + 1.5F * warp) +
                                                                  std::cos(9 * y * z) +
                                                                  0.8F * std::sin(11 * z - 5 * x + warp);
              return std::clamp(0.45F + 0.22F * cloud, 0.0F, 1.0F);
            };
            auto scene =
                caster_scene(canvas, {.fragment = doubled_where_transparent,
                                      .grid = sampled(56, nebula),
                                      .format = {.texel = Texel::float32},
                                      .table = colours_from(0),
                                      .step_length = 0.03F,
                                      .orbit = {.azimuth = 75, .elevation = -20, .degrees_each_frame = 2}});
            return [&canvas, scene](int frame) {
              if (frame == 11 || frame == 22) {
                const std::vector<Colour> colours = colours_from(frame == 11 ? 0.45F : 0.3F);
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        colours.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
