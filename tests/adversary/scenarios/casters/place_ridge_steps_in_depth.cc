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

/// The ray's points are those of equally spaced depths in the window, which lie closer near the eye.
const std::string steps_of_depth = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform mat4 clip_from_object;
uniform mat4 object_from_clip;
uniform vec3 eye;
uniform float depth_step;
in vec3 at;
out vec4 shown;

void main() {
  vec4 clip = clip_from_object * vec4(at, 1.0);
  vec3 ndc = clip.xyz / clip.w;
  vec4 acc = vec4(0.0);
  for (int i = 0; i < 500; ++i) {
    vec4 p = object_from_clip * vec4(ndc, 1.0);
    p.xyz /= p.w;
    if (any(lessThan(p.xyz, vec3(-1e-4))) || any(greaterThan(p.xyz, vec3(1.0001)))) break;
    vec4 c = texture(table, vec2(texture(volume, p.xyz).r, 0.5));
    acc += (1.0 - acc.a) * vec4(c.rgb * c.a, c.a);
    ndc.z += depth_step;
  }
  shown = acc;
}
)";

}  // namespace

Scenario place_ridge_steps_in_depth() {
  return {
      .sentence =
          "A ridge of 48 x 32 x 56 texels of 16 bits whose samples lie at equal steps of the window's depth, "
          "so "
          "that they are closer near the eye; the eye comes nearer.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field ridge = [](float x, float y, float z) {
          const float height =
              0.45F + 0.2F * std::sin(8 * x + 2) * std::cos(6 * z) + 0.08F * std::sin(21 * x * z);
          return std::clamp(0.5F + 1.8F * (height - y) + 0.12F * std::sin(17 * z + 9 * y), 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float v = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(100 + 120 * v), static_cast<std::uint8_t>(210 - 130 * v),
                             static_cast<std::uint8_t>(80 + 90 * std::abs(std::sin(7 * v))),
                             static_cast<std::uint8_t>(std::lround(2 + 11 * v))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = steps_of_depth,
                                  .grid = sampled(48, 32, 56, ridge),
                                  .format = {.texel = Texel::unsigned16},
                                  .table = colours,
                                  .orbit = {.azimuth = 130, .elevation = 28, .degrees_each_frame = 1.5F}});
        return [scene](int frame) {
          scene->settings.orbit.distance = 3.2F - 0.05F * static_cast<float>(frame);
          const Camera camera = scene->camera(frame);
          const Matrix& p = camera.projection;
          const Matrix& v = camera.view;
          const Matrix object_from_view{v[0], v[4], v[8],  0, v[1],         v[5],         v[9],         0,
                                        v[2], v[6], v[10], 0, camera.eye.x, camera.eye.y, camera.eye.z, 1};
          const Matrix view_from_clip{1 / p[0], 0, 0, 0,         0, 1 / p[5], 0,  0,
                                      0,        0, 0, 1 / p[14], 0, 0,        -1, p[10] / p[14]};
          scene->program.use();
          scene->program.set("object_from_clip", object_from_view * view_from_clip);
          scene->program.set("depth_step", 0.0008F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
