// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_central_then_forward() {
  return {
      .sentence =
          "Light from the eye by differences between a voxel ahead and one behind; from frame 12 on the one "
          "behind is the sample itself, by a uniform.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        // Small curved things of few voxels: beads on two crossing wires, in a thin hull.
        const Field field = [](float x, float y, float z) {
          float rest = 1;
          for (int i = 0; i < 5; ++i) {
            const float along = 0.18F + 0.16F * static_cast<float>(i);
            const auto bead = [&](float cx, float cy, float cz, float amount) {
              const float a = x - cx, b = y - cy, c = z - cz;
              return 1 - amount * std::exp(-190 * (a * a + b * b + c * c));
            };
            rest *= bead(along, 0.42F, 0.2F + 0.7F * along, 0.92F);
            rest *= bead(1 - along, 0.3F + 0.5F * along, 0.5F, 0.6F);
          }
          const float a = x - 0.5F, b = 1.3F * (y - 0.5F), c = z - 0.5F;
          const float hull = std::sqrt(a * a + b * b + c * c) - 0.43F;
          return 1 - rest * (1 - 0.28F * std::exp(-260 * hull * hull));
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float hull = std::exp(-std::pow((at - 0.17F) / 0.045F, 2.0F));
          const float bead = at > 0.34F ? 1 - std::exp(-std::pow((at - 0.34F) / 0.15F, 2.0F)) : 0;
          table.push_back({static_cast<std::uint8_t>(at < 0.3F ? 90 : 200),
                           static_cast<std::uint8_t>(at < 0.3F ? 140 : 230 - 120 * at),
                           static_cast<std::uint8_t>(at < 0.3F ? 200 : 60 + 90 * at),
                           static_cast<std::uint8_t>(std::lround(9 * hull + 100 * bead))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform float ahead;
uniform float behind;
in vec3 at;
out vec4 shown;

vec3 difference(vec3 p) {
  vec3 there = vec3(texture(volume, p + vec3(ahead, 0, 0)).r, texture(volume, p + vec3(0, ahead, 0)).r,
                    texture(volume, p + vec3(0, 0, ahead)).r);
  vec3 here = vec3(texture(volume, p - vec3(behind, 0, 0)).r, texture(volume, p - vec3(0, behind, 0)).r,
                   texture(volume, p - vec3(0, 0, behind)).r);
  return (there - here) / (ahead + behind);
}

void main() {
  vec3 ray = normalize(at - eye);
  vec3 ends = (step(0.0, ray) - at) / ray;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec3 p = at + float(i) * step_length * ray;
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    if (c.a > 0.0) {
      vec3 g = difference(p);
      float steep = length(g);
      float lambert = steep > 1e-4 ? max(dot(g / steep, ray), 0.0) : 0.0;
      c.rgb = c.rgb * (0.2 + 0.6 * lambert) + 0.2 * pow(lambert, 14.0);
      sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    }
  }
  shown = sum;
}
)",
                                  .grid = sampled(40, field),
                                  .format = {.texel = Texel::float32},
                                  .table = table,
                                  .step_length = 0.018F,
                                  .orbit = {.azimuth = 190, .elevation = 33, .degrees_each_frame = 2}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("ahead", 1 / 40.0F);
          scene->program.set("behind", frame < 12 ? 1 / 40.0F : 0.0F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
