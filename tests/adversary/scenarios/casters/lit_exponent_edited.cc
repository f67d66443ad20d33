// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_exponent_edited() {
  return {
      .sentence =
          "Blinn and Phong's light from the eye; the exponent is 50, from frame 10 on 4, from frame 20 on 15. "
          "Nothing else changes but the camera.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        // Two linked rings, one of them thick, and a lens between them.
        const Field field = [](float x, float y, float z) {
          const float a = std::hypot(x - 0.38F, y - 0.5F) - 0.22F, b = z - 0.5F;
          const float c = std::hypot(x - 0.62F, z - 0.5F) - 0.22F, d = y - 0.5F;
          const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
          const float thin = 0.6F * std::exp(-150 * (a * a + b * b));
          const float thick = 0.95F * std::exp(-85 * (c * c + d * d));
          const float lens = 0.35F * std::exp(-60 * v * v - 9 * (u * u + w * w));
          return 1 - (1 - thin) * (1 - thick) * (1 - lens);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float glass = std::exp(-std::pow((at - 0.26F) / 0.06F, 2.0F));
          const float copper = std::exp(-std::pow((at - 0.56F) / 0.1F, 2.0F));
          const float steel = std::exp(-std::pow((at - 0.88F) / 0.1F, 2.0F));
          const float all = glass + copper + steel + 1e-9F;
          table.push_back({static_cast<std::uint8_t>((60 * glass + 170 * copper + 110 * steel) / all),
                           static_cast<std::uint8_t>((130 * glass + 85 * copper + 120 * steel) / all),
                           static_cast<std::uint8_t>((110 * glass + 50 * copper + 140 * steel) / all),
                           static_cast<std::uint8_t>(std::lround(14 * glass + 40 * copper + 70 * steel))});
        }
        auto scene = caster_scene(canvas, {.fragment = R"(#version 410 core
in vec3 at;
layout(location = 0) out vec4 outColor;
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform float shininess;

const float ambient = 0.3, diffuse = 0.4, specular = 0.35;
const float h = 1.0 / 64.0;

float f(float x, float y, float z) { return texture(volume, vec3(x, y, z)).r; }

vec4 blinn(vec4 c, vec3 q, vec3 toEye) {
  vec3 grad = 0.5 / h * vec3(f(q.x + h, q.y, q.z) - f(q.x - h, q.y, q.z),
                             f(q.x, q.y + h, q.z) - f(q.x, q.y - h, q.z),
                             f(q.x, q.y, q.z + h) - f(q.x, q.y, q.z - h));
  float size = length(grad);
  if (size < 1e-4) return vec4(ambient * c.rgb, c.a);
  vec3 normal = grad / -size;
  vec3 halfVector = normalize(toEye + toEye);
  float nl = dot(normal, toEye), nh = dot(normal, halfVector);
  vec3 lit = c.rgb * (ambient + diffuse * abs(nl)) + vec3(specular) * pow(abs(nh), shininess);
  return vec4(lit, c.a);
}

void main() {
  vec3 dir = normalize(at - eye);
  vec3 sides = (step(0.0, dir) - at) / dir;
  int n = int(ceil(min(sides.x, min(sides.y, sides.z)) / step_length));
  vec4 sum = vec4(0.0);
  vec3 q = at;
  while (n-- > 0) {
    vec4 c = blinn(texture(table, vec2(f(q.x, q.y, q.z), 0.5)), q, -dir);
    sum.rgb += (1.0 - sum.a) * c.a * c.rgb;
    sum.a += (1.0 - sum.a) * c.a;
    q += step_length * dir;
  }
  outColor = sum;
}
)",
                                           .grid = sampled(64, field),
                                           .format = {.texel = Texel::unsigned16},
                                           .table = table,
                                           .step_length = 0.02F,
                                           .orbit = {.azimuth = 20, .elevation = 40, .degrees_each_frame = 2}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("shininess", frame < 10 ? 50.0F : frame < 20 ? 4.0F : 15.0F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
