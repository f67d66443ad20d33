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

Scenario place_comet_two_passes() {
  return {.sentence =
              "A comet of 56 x 36 x 36 bytes: front and back faces are drawn into two float textures first, "
              "from which "
              "the box's front faces, drawn again, get the rays' ends. From frame 14 on those of the first "
              "passes are "
              "of a smaller box.",
          .expectation = Expectation::either,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            const char* const boxVertex = R"(#version 330 core
layout(location = 0) in vec3 a_pos;
uniform mat4 u_mvp;
out vec3 v_texcoord;
void main() {
    v_texcoord = a_pos;
    gl_Position = u_mvp * vec4(a_pos, 1.0);
}
)";
            const GlslProgram faces(canvas, boxVertex, R"(#version 330 core
in vec3 v_texcoord;
out vec4 o_position;
void main() { o_position = vec4(v_texcoord, 1.0); }
)");
            const GlslProgram rays(canvas, boxVertex, R"(#version 330 core
uniform sampler2D u_entry;
uniform sampler2D u_exit;
uniform sampler3D u_volume;
uniform sampler2D u_tf;
uniform vec2 u_screenSize;
uniform float u_stepSize;
in vec3 v_texcoord;
out vec4 o_color;
void main() {
    vec2 st = gl_FragCoord.xy / u_screenSize;
    vec4 entry = texture(u_entry, st);
    vec4 exit = texture(u_exit, st);
    if (entry.a == 0.0 || exit.a == 0.0) discard;
    vec3 dir = exit.xyz - entry.xyz;
    float len = length(dir);
    vec3 deltaDir = normalize(dir) * u_stepSize;
    float deltaDirLen = length(deltaDir);
    vec3 voxelCoord = entry.xyz;
    vec4 colorAcum = vec4(0.0);
    float lengthAcum = 0.0;
    for (int i = 0; i < 1600; i++) {
        float intensity = texture(u_volume, voxelCoord).x;
        vec4 colorSample = texture(u_tf, vec2(intensity, 0.5));
        if (colorSample.a > 0.0) {
            colorSample.a = 1.0 - pow(1.0 - colorSample.a, u_stepSize * 50.0);
            colorAcum.rgb += (1.0 - colorAcum.a) * colorSample.rgb * colorSample.a;
            colorAcum.a += (1.0 - colorAcum.a) * colorSample.a;
        }
        voxelCoord += deltaDir;
        lengthAcum += deltaDirLen;
        if (lengthAcum >= len) break;
        if (colorAcum.a > 0.99) break;
    }
    o_color = colorAcum;
}
)");
            const Gl& gl = canvas.gl;
            std::array<GLuint, 2> framebuffers{}, textures{};
            gl.GenFramebuffers(2, framebuffers.data());
            gl.GenTextures(2, textures.data());
            for (int i = 0; i < 2; ++i) {
              gl.ActiveTexture(GL_TEXTURE2 + static_cast<GLenum>(i));
              gl.BindTexture(GL_TEXTURE_2D, textures.at(i));
              filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
              gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, canvas.width(), canvas.height(), 0, GL_RGBA, GL_FLOAT,
                            nullptr);
              gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers.at(i));
              gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures.at(i), 0);
            }
            const VertexBuffer cube(canvas);
            const Field comet = [](float x, float y, float z) {
              const float a = x - 0.25F, b = y - 0.5F, c = z - 0.5F;
              const float head = std::exp(-28 * (a * a + b * b + c * c));
              const float width = 0.08F + 0.3F * std::max(0.0F, x - 0.25F);
              const float tail =
                  std::exp(-(b * b + c * c) / (width * width)) * std::clamp(1.2F - x, 0.0F, 1.0F);
              const float streaks = 0.75F + 0.25F * std::sin(34 * b + 5 * x) * std::cos(29 * c - 9 * x);
              return std::clamp(0.55F * head + 0.55F * tail * streaks, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(60 + 190 * at),
                               static_cast<std::uint8_t>(120 + 100 * std::sin(5 * at)),
                               static_cast<std::uint8_t>(250 - 160 * at),
                               static_cast<std::uint8_t>(std::lround(at < 0.05F ? 0.0F : 4 + 90 * at * at))});
            }
            upload_volume(canvas, 0, sampled(56, 36, 36, comet));
            upload_table_2d(canvas, 1, table);
            return [&canvas, faces, rays, framebuffers, cube](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera =
                  camera_at({.azimuth = 15, .elevation = 18, .distance = 2.5F, .degrees_each_frame = 2.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              std::vector<Vector> clipped = box_triangles();
              if (frame >= 14)
                for (Vector& corner : clipped)
                  corner = {0.15F + 0.7F * corner.x, 0.1F + 0.55F * corner.y, 0.05F + 0.9F * corner.z};
              gl.Enable(GL_CULL_FACE);
              gl.Disable(GL_BLEND);
              faces.use();
              faces.set("u_mvp", camera.clip_from_object());
              for (int i = 0; i < 2; ++i) {
                gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers.at(i));
                gl.Viewport(0, 0, canvas.width(), canvas.height());
                gl.ClearColor(0, 0, 0, 0);
                gl.Clear(GL_COLOR_BUFFER_BIT);
                gl.CullFace(i == 0 ? GL_BACK : GL_FRONT);
                cube.draw(clipped);
              }
              canvas.begin(0.02F, 0.03F, 0.1F);
              rays.use();
              rays.set("u_mvp", camera.clip_from_object());
              rays.set("u_volume", 0);
              rays.set("u_tf", 1);
              rays.set("u_entry", 2);
              rays.set("u_exit", 3);
              gl.Uniform2f(rays.location("u_screenSize"), static_cast<float>(canvas.width()),
                           static_cast<float>(canvas.height()));
              rays.set("u_stepSize", 1.0F / 56);
              set_blending(gl, Blending::premultiplied_over);
              gl.CullFace(GL_BACK);
              cube.draw(box_triangles());
              gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
