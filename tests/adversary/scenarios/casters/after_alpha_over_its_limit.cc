// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario after_alpha_over_its_limit() {
  return {
      .sentence =
          "A coil of 40 x 40 x 40 half floats in GLSL 1.50: rays end where alpha reaches 0.9; afterwards the "
          "colour is divided by alpha, alpha by 0.9 and clamped to 1, and both are blended by SRC_ALPHA.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 150
in vec3 position;
uniform mat4 mvp;
out vec3 entry;
void main()
{
    entry = position;
    gl_Position = mvp * vec4(position, 1.0);
}
)",
                                  R"(#version 150
#define ALPHA_LIMIT 0.9
uniform sampler3D volumeSampler;
uniform sampler2D colormap;
uniform vec3 cameraPos;
uniform int steps;
in vec3 entry;
out vec4 color;

void main()
{
    vec3 rayDir = normalize(entry - cameraPos);
    float stepSize = 1.0 / float(steps);
    vec3 pos = entry;
    vec3 rgb = vec3(0.0);
    float a = 0.0;
    for (int i = 0; i < 2 * steps; ++i)
    {
        if (pos.x < 0.0 || pos.x > 1.0 || pos.y < 0.0 || pos.y > 1.0 || pos.z < 0.0 || pos.z > 1.0)
            break;
        vec4 c = texture(colormap, vec2(texture(volumeSampler, pos).r, 0.5));
        rgb = rgb + (1.0 - a) * c.a * c.rgb;
        a = a + (1.0 - a) * c.a;
        if (a >= ALPHA_LIMIT)
            break;
        pos += stepSize * rayDir;
    }
    color.rgb = a > 0.0 ? rgb / a : vec3(0.0);
    color.a = clamp(a / ALPHA_LIMIT, 0.0, 1.0);
}
)");
        const VertexBuffer vertices(canvas);
        const Field coil = [](float x, float y, float z) {
          const float angle = 14 * y;
          const float a = x - 0.5F - 0.27F * std::cos(angle), b = z - 0.5F - 0.27F * std::sin(angle);
          const float haze = 0.16F + 0.1F * std::sin(9 * x - 5 * z) * std::cos(7 * y);
          return std::clamp(haze + 0.85F * std::exp(-70 * (a * a + b * b)), 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float wire = std::clamp((at - 0.4F) / 0.4F, 0.0F, 1.0F);
          colours.push_back({static_cast<std::uint8_t>(60 + 180 * wire),
                             static_cast<std::uint8_t>(110 + 60 * std::sin(6 * at)),
                             static_cast<std::uint8_t>(200 - 170 * wire),
                             static_cast<std::uint8_t>(std::lround(9 * std::min(1.0F, 4 * at) + 100 * wire))});
        }
        upload_volume(canvas, 0, sampled(40, coil), {.texel = Texel::half});
        upload_table_2d(canvas, 1, colours);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 140, .elevation = -22, .distance = 2.3F, .degrees_each_frame = 2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.9F, 0.88F, 0.8F);
          program.use();
          program.set("volumeSampler", 0);
          program.set("colormap", 1);
          program.set("mvp", camera.clip_from_object());
          program.set("cameraPos", camera.eye);
          program.set("steps", 64);
          set_blending(canvas.gl, Blending::over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
