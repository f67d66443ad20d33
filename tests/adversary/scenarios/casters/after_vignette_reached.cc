// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_vignette_reached() {
  return {
      .sentence =
          "A sponge of 44 x 44 x 44 bytes in GLSL 1.40: the final colour darkens towards the window's corners, "
          "by a varying of clip coordinates, and stays as it is within 0.55 of the window's middle. At first "
          "the sponge is within, and comes nearer until it fills the window.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field sponge = [](float x, float y, float z) {
          const float holes = std::cos(17 * x + 1) * std::cos(15 * y) +
                              std::cos(15 * y) * std::cos(16 * z + 2) +
                              std::cos(16 * z + 2) * std::cos(17 * x + 1);
          return std::clamp(0.5F + 0.25F * holes + 0.2F * (x - z), 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(240 - 60 * at),
                             static_cast<std::uint8_t>(200 - 120 * at),
                             static_cast<std::uint8_t>(80 + 60 * std::sin(9 * at)),
                             static_cast<std::uint8_t>(std::lround(1 + 40 * at * at))});
        }
        auto scene = caster_scene(canvas, {.fragment = R"(#version 140
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 rayStart;
in vec4 clipPos;
out vec4 colorOut;

float vignette(vec2 ndc)
{
    return 1.0 - 0.8 * smoothstep(0.55, 1.3, length(ndc));
}

void main()
{
    vec3 dir = normalize(rayStart - eye);
    vec3 pos = rayStart;
    vec4 acc = vec4(0.0);
    for (int i = 0; i < 160; i++)
    {
        if (any(lessThan(pos, vec3(0.0))) || any(greaterThan(pos, vec3(1.0))) || acc.a > 0.98)
            break;
        vec4 c = texture(table, vec2(texture(volume, pos).r, 0.5));
        c.rgb *= c.a;
        acc += c * (1.0 - acc.a);
        pos += dir * step_length;
    }
    colorOut = vec4(acc.rgb * vignette(clipPos.xy / clipPos.w), acc.a);
}
)",
                                           .vertex = R"(#version 140
in vec3 position;
uniform mat4 clip_from_object;
out vec3 rayStart;
out vec4 clipPos;
void main()
{
    rayStart = position;
    clipPos = clip_from_object * vec4(position, 1.0);
    gl_Position = clipPos;
}
)",
                                           .grid = sampled(44, sponge),
                                           .table = colours,
                                           .step_length = 0.02F,
                                           .background = {0.3F, 0.35F, 0.4F, 1}});
        return [&canvas, scene](int frame) {
          const Orbit orbit{.azimuth = 45,
                            .elevation = 25,
                            .distance = std::max(1.9F, 5.5F - 0.15F * static_cast<float>(frame)),
                            .degrees_each_frame = 1.5F};
          canvas.begin(0.3F, 0.35F, 0.4F);
          scene->draw_box(camera_at(orbit, frame,
                                    static_cast<float>(canvas.width()) / static_cast<float>(canvas.height())));
        };
      }};
}

}  // namespace adversary::casters
