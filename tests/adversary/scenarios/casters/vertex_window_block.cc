// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
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

Scenario vertex_window_block() {
  return {.sentence =
              "A chest of 64 x 64 x 40 in 16 bits in GLSL 3.30. The window of values (centre and width) and "
              "the step lie in a uniform block of the fragment shader alone, the camera in plain uniforms; "
              "values in the window are looked up in a table. The window is another one from frame 10 on, and "
              "from frame 20 on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 mvp;
out vec3 uvw;

void main()
{
    uvw = position;
    gl_Position = mvp * vec4(position, 1.0);
}
)",
                                      R"(#version 330 core
layout(std140) uniform Display
{
    float centre;
    float width;
    float stepSize;
} display;

uniform sampler3D scan;
uniform sampler2D lut;
uniform vec3 eyePosition;

in vec3 uvw;
out vec4 fragColor;

float windowed(float value)
{
    return clamp((value - display.centre) / display.width + 0.5, 0.0, 1.0);
}

void main()
{
    vec3 direction = normalize(uvw - eyePosition);
    vec3 walls = max((vec3(0.0) - uvw) / direction, (vec3(1.0) - uvw) / direction);
    float far = min(walls.x, min(walls.y, walls.z));

    vec4 sum = vec4(0.0);
    for (float t = 0.0; t < far; t += display.stepSize)
    {
        float value = texture(scan, uvw + t * direction).r;
        vec4 entry = texture(lut, vec2(windowed(value), 0.5));
        sum.rgb += (1.0 - sum.a) * entry.a * entry.rgb;
        sum.a += (1.0 - sum.a) * entry.a;
    }
    fragColor = sum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field chest = [](float x, float y, float z) {
              const auto egg = [&](float cx, float cy, float cz, float rx, float ry, float rz) {
                const float a = (x - cx) / rx, b = (y - cy) / ry, c = (z - cz) / rz;
                return 1 / (1 + std::exp(9 * (std::sqrt(a * a + b * b + c * c) - 1)));
              };
              const float body = egg(0.5F, 0.48F, 0.5F, 0.44F, 0.62F, 0.36F);
              const float lungs =
                  egg(0.3F, 0.5F, 0.5F, 0.14F, 0.3F, 0.22F) + egg(0.7F, 0.52F, 0.48F, 0.14F, 0.33F, 0.22F);
              const float heart = egg(0.54F, 0.42F, 0.58F, 0.13F, 0.16F, 0.14F);
              const float a = x - 0.5F, c = z - 0.27F;
              const float spine = std::exp(-240 * (a * a + c * c)) * (0.85F + 0.15F * std::sin(40 * y));
              const float rind = body * (1 - body) * 4;
              const float ribs = rind * std::pow(0.5F + 0.5F * std::sin(38 * y + 5 * x), 2.0F);
              return std::clamp(
                  0.04F + 0.36F * body - 0.22F * lungs + 0.22F * heart + 0.45F * spine + 0.3F * ribs, 0.0F,
                  1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(110 + 140 * at),
                               static_cast<std::uint8_t>(40 + 190 * at * at),
                               static_cast<std::uint8_t>(90 + 90 * std::sin(5 * at)),
                               static_cast<std::uint8_t>(std::lround(36 * at * at))});
            }
            upload_volume(canvas, 0, sampled(64, 64, 40, chest), {.texel = Texel::unsigned16});
            upload_table_2d(canvas, 1, table);
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, 4 * sizeof(float), nullptr, GL_STATIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, block);
            canvas.gl.UniformBlockBinding(program.name(),
                                          canvas.gl.GetUniformBlockIndex(program.name(), "Display"), 0);
            program.use();
            program.set("scan", 0);
            program.set("lut", 1);
            return [&canvas, program, vertices, block](int frame) {
              if (frame == 0 || frame == 10 || frame == 20) {
                constexpr float step = 0.018F;
                // All of it; what is hard; what is soft.
                const std::array<float, 3> display = frame == 0    ? std::array{0.45F, 0.8F, step}
                                                     : frame == 10 ? std::array{0.52F, 0.44F, step}
                                                                   : std::array{0.32F, 0.5F, step};
                canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
                canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(display), display.data());
              }
              const Camera camera =
                  camera_at({.azimuth = -30, .elevation = 14, .distance = 2.4F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.04F, 0.08F, 0.1F);
              program.use();
              program.set("mvp", camera.clip_from_object());
              program.set("eyePosition", camera.eye);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
