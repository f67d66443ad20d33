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

Scenario ends_foam_lit_from_the_eye() {
  return {.sentence =
              "Foam of 40 x 40 x 40 floats in GLSL 4.30, lit from the eye on both sides with a highlight of "
              "exponent "
              "24, under a dense 1-D table: rays end where alpha >= 0.985.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 mvp;
layout(location = 0) out vec3 entry;

void main()
{
    entry = position;
    gl_Position = mvp * vec4(position, 1.0);
}
)",
                                      R"(#version 430 core
layout(binding = 0) uniform sampler3D foam;
layout(binding = 1) uniform sampler1D transfer;
layout(location = 1) uniform vec3 eye;
layout(location = 2) uniform float dt;

layout(location = 0) in vec3 entry;
layout(location = 0) out vec4 color;

vec3 gradient(vec3 p)
{
    vec3 h = 1.0 / vec3(textureSize(foam, 0));
    return vec3(
        texture(foam, p + vec3(h.x, 0, 0)).r - texture(foam, p - vec3(h.x, 0, 0)).r,
        texture(foam, p + vec3(0, h.y, 0)).r - texture(foam, p - vec3(0, h.y, 0)).r,
        texture(foam, p + vec3(0, 0, h.z)).r - texture(foam, p - vec3(0, 0, h.z)).r);
}

void main()
{
    vec3 dir = normalize(entry - eye);
    vec3 exits = (step(vec3(0.0), dir) - entry) / dir;
    float tEnd = min(exits.x, min(exits.y, exits.z));

    vec4 acc = vec4(0.0);
    for (float t = 0.0; t <= tEnd; t += dt)
    {
        vec3 p = entry + t * dir;
        vec4 src = texture(transfer, texture(foam, p).r);
        if (src.a > 0.0)
        {
            vec3 g = gradient(p);
            float l = length(g);
            float facing = l > 0.0 ? abs(dot(g / l, dir)) : 0.0;
            src.rgb = src.rgb * (0.3 + 0.7 * facing) + vec3(0.25 * pow(facing, 24.0));
            acc.rgb += (1.0 - acc.a) * src.a * src.rgb;
            acc.a += (1.0 - acc.a) * src.a;
            if (acc.a >= 0.985)
                break;
        }
    }
    color = acc;
}
)");
            const VertexBuffer vertices(canvas);
            const Field foam = [](float x, float y, float z) {
              const float cells = std::sin(11 * x + 1) * std::sin(10 * y) +
                                  std::sin(10 * y + 2) * std::sin(12 * z) +
                                  std::sin(12 * z + 1) * std::sin(11 * x + 0.5F);
              return std::clamp(0.4F + 0.28F * cells + 0.15F * (y - x), 0.0F, 1.0F);
            };
            std::vector<Colour> transfer;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float wall = std::clamp((at - 0.3F) / 0.4F, 0.0F, 1.0F);
              transfer.push_back({static_cast<std::uint8_t>(60 + 160 * at),
                                  static_cast<std::uint8_t>(190 - 90 * at),
                                  static_cast<std::uint8_t>(120 + 90 * std::sin(4 * at)),
                                  static_cast<std::uint8_t>(std::lround(110 * wall * wall))});
            }
            upload_volume(canvas, 0, sampled(40, foam), {.texel = Texel::float32});
            upload_table_1d(canvas, 1, transfer);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 140, .elevation = 15, .distance = 2.5F, .degrees_each_frame = 1.2F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.05F, 0.05F, 0.1F);
              program.use();
              program.set("mvp", camera.clip_from_object());
              program.set("eye", camera.eye);
              program.set("dt", 0.016F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
