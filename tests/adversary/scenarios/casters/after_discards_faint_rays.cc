// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_discards_faint_rays() {
  return {
      .sentence =
          "Tufts of 48 x 48 x 32 signed 16-bit texels in GLSL 3.30, depth tested and written: rays of an alpha "
          "below 0.05 are discarded after the loop, others are divided by it and blended by SRC_ALPHA. A "
          "triangle "
          "behind the front faces is drawn afterwards, and is seen where rays were discarded. At frame 10 the "
          "limit becomes 0.3.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram flat(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(0.9, 0.4 + 0.3 * sin(9.0 * at.x), 0.2, 1.0); }
)");
        const Field tufts = [](float x, float y, float z) {
          const float bunch = std::sin(9 * x + 1) * std::sin(8 * z) + 0.5F * std::sin(15 * x * z + 4 * y);
          return std::clamp(1.2F * bunch - 0.5F - 0.6F * y, -1.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float hair = std::clamp((at - 0.05F) / 0.6F, 0.0F, 1.0F);
          colours.push_back({static_cast<std::uint8_t>(70 + 140 * at),
                             static_cast<std::uint8_t>(200 - 120 * at),
                             static_cast<std::uint8_t>(120 + 90 * std::sin(7 * at)),
                             static_cast<std::uint8_t>(std::lround(30 * hair))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform float alphaThreshold;
in vec3 at;
out vec4 fragment;

void main() {
  vec3 dir = normalize(at - eye);
  vec4 accum = vec4(0.0);
  vec3 pos = at;
  for (int i = 0; i < 200; ++i) {
    float v = max(texture(volume, pos).r, 0.0);
    vec4 c = texture(table, vec2(v, 0.5));
    accum.rgb += (1.0 - accum.a) * c.a * c.rgb;
    accum.a += (1.0 - accum.a) * c.a;
    pos += step_length * dir;
    if (any(greaterThan(abs(pos - 0.5), vec3(0.5)))) break;
  }
  if (accum.a < alphaThreshold) discard;
  fragment = vec4(accum.rgb / accum.a, accum.a);
}
)",
                                  .grid = sampled(48, 48, 32, tufts),
                                  .format = {.texel = Texel::signed16},
                                  .table = colours,
                                  .blending = Blending::over,
                                  .step_length = 0.018F,
                                  .orbit = {.azimuth = 200, .elevation = 30, .degrees_each_frame = 3}});
        return [&canvas, flat, scene](int frame) {
          canvas.begin(0.15F, 0.2F, 0.3F);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->program.use();
          scene->program.set("alphaThreshold", frame < 10 ? 0.05F : 0.3F);
          scene->draw_box(scene->camera(frame));
          flat.use();
          flat.set("clip_from_object", identity);
          canvas.gl.Disable(GL_BLEND);
          scene->vertices.draw(
              std::array<Vector, 3>{Vector{-0.8F, -0.7F, 0.995F}, {0.8F, -0.5F, 0.995F}, {0.1F, 0.9F, 0.995F}});
          canvas.gl.Disable(GL_DEPTH_TEST);
        };
      }};
}

}  // namespace adversary::casters
