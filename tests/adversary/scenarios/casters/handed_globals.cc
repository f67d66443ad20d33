// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario handed_globals() {
  return {
      .sentence =
          "A walrus tooth of 48 x 60 x 52 in 16 bits in GLSL 4.40, by shaders as a cross-compiler writes them: "
          "both read one block of forty vec4, rewritten whole in every frame, with the matrix's rows, the eye, "
          "step and window, and a cutting plane. The vertex shader hands on the distance from the plane in w; "
          "samples beyond it are left out. It misses the box until frame 15, and lies in it from then on.",
      .expectation = Expectation::either,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 440 core
layout(std140, binding = 0) uniform Globals
{
    vec4 c[40];
};
layout(location = 0) in vec4 in_POSITION0;
layout(location = 0) out vec4 vs_TEXCOORD0;
layout(location = 1) out vec4 vs_TEXCOORD1;
vec4 r0;
vec4 r1;

void main()
{
    r0.xyz = in_POSITION0.xyz;
    r0.w = 1.0;
    gl_Position.x = dot(c[0], r0);
    gl_Position.y = dot(c[1], r0);
    gl_Position.z = dot(c[2], r0);
    gl_Position.w = dot(c[3], r0);
    r1.xyz = r0.xyz + (-c[4].xyz);
    r1.w = dot(c[20].xyz, r1.xyz);
    vs_TEXCOORD1 = r1;
    r0.w = dot(c[20], r0);
    vs_TEXCOORD0 = r0;
}
)",
                                  R"(#version 440 core
layout(std140, binding = 0) uniform Globals
{
    vec4 c[40];
};
layout(binding = 0) uniform sampler3D s0;
layout(binding = 1) uniform sampler2D s1;
layout(location = 0) in vec4 vs_TEXCOORD0;
layout(location = 1) in vec4 vs_TEXCOORD1;
layout(location = 0) out vec4 SV_Target0;
vec4 r0;
vec4 r1;
vec4 r2;
vec4 r3;

void main()
{
    r0.x = dot(vs_TEXCOORD1.xyz, vs_TEXCOORD1.xyz);
    r0.x = inversesqrt(r0.x);
    r0 = r0.xxxx * vs_TEXCOORD1;
    r1.xyz = step(vec3(0.0), r0.xyz);
    r1.xyz = r1.xyz + (-vs_TEXCOORD0.xyz);
    r1.xyz = r1.xyz / r0.xyz;
    r1.x = min(r1.y, r1.x);
    r1.x = min(r1.z, r1.x);
    r2 = vec4(0.0);
    r1.y = 0.0;
    while (true)
    {
        if (r1.y >= r1.x) break;
        r3 = r1.yyyy * r0 + vs_TEXCOORD0;
        r1.y = r1.y + c[5].x;
        if (r3.w < 0.0) continue;
        r3.x = texture(s0, r3.xyz).x;
        r3.x = r3.x + (-c[5].y);
        r3.x = r3.x * c[5].z;
        r3.y = 0.5;
        r3 = texture(s1, r3.xy);
        r3.xyz = r3.www * r3.xyz;
        r1.z = (-r2.w) + 1.0;
        r2 = r1.zzzz * r3 + r2;
    }
    SV_Target0 = r2;
}
)");
        const VertexBuffer vertices(canvas);
        const Field tooth = [](float x, float y, float z) {
          // Narrower upwards, and bent.
          const float a = x - 0.5F - 0.5F * (y - 0.45F) * (y - 0.45F), c = z - 0.48F + 0.16F * (y - 0.5F);
          const float away = std::sqrt(a * a + 0.9F * c * c) + 0.02F * std::sin(11 * y + 6 * x);
          const float wide = 0.4F - 0.26F * y * y;
          const float whole = std::clamp(9 * (wide - away) + 0.3F, 0.0F, 1.0F) *
                              std::clamp(12 * y - 0.6F, 0.0F, 1.0F) * std::clamp(9 - 9.6F * y, 0.0F, 1.0F);
          const float layers = 0.5F + 0.5F * std::sin(26 * away / (0.5F + wide) + 4 * y);
          const float marbled = std::sin(14 * x + 3 * std::sin(7 * y)) * std::cos(13 * z - 9 * y);
          return std::clamp(
              0.1F + whole * (0.2F + 0.3F * layers + 0.14F * marbled) + 0.02F * std::cos(9 * x - 8 * z), 0.0F,
              1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float ivory = std::clamp((at - 0.22F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(150 + 95 * ivory),
                           static_cast<std::uint8_t>(110 + 110 * std::sin(2.4F * at)),
                           static_cast<std::uint8_t>(190 - 120 * ivory),
                           static_cast<std::uint8_t>(std::lround(2 + 4 * at + 36 * ivory))});
        }
        upload_volume(canvas, 0, sampled(48, 60, 52, tooth), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table);
        using Register = std::array<float, 4>;
        using Registers = std::array<Register, 40>;
        GLuint block = 0;
        canvas.gl.GenBuffers(1, &block);
        canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
        canvas.gl.BufferData(GL_UNIFORM_BUFFER, sizeof(Registers), nullptr, GL_DYNAMIC_DRAW);
        canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, block);
        return [&canvas, program, vertices, block](int frame) {
          const Camera camera =
              camera_at({.azimuth = 320, .elevation = 14, .distance = 2.35F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          Registers registers{};
          const Matrix clip = camera.clip_from_object();
          for (std::size_t row = 0; row < 4; ++row)
            registers[row] = {clip[row], clip[4 + row], clip[8 + row], clip[12 + row]};
          registers[4] = {camera.eye.x, camera.eye.y, camera.eye.z, 1};
          constexpr float window_low = 0.05F, window_high = 0.85F;
          registers[5] = {0.0165F, window_low, 1 / (window_high - window_low), 0};
          // Others that the engine fills in, and these shaders do not read.
          registers[8] = {0.3F, 0.9F, 0.3F, 0};
          registers[9] = {1, 0.95F, 0.9F, 1};
          // What lies before it, as the eye sees it, is left out.
          const Vector normal = normalized({0.4F, -0.25F, -0.85F});
          const float at_plane = frame < 15 ? -1.8F : dot(normal, {0.5F, 0.5F, 0.5F});
          registers[20] = {normal.x, normal.y, normal.z, -at_plane};
          canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
          canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(registers), registers.data());
          canvas.begin(0.06F, 0.13F, 0.13F);
          program.use();
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
