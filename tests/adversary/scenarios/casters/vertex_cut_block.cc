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

Scenario vertex_cut_block() {
  return {.sentence =
              "A coral of 48 x 60 x 52 in 16 bits in GLSL 4.20. Matrix, eye and a cutting plane lie in one "
              "uniform block of both shaders, which glBufferSubData rewrites whole in every frame; samples "
              "beyond the plane are left out. It misses the box until frame 14, and lies in it from then on.",
          .expectation = Expectation::either,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 aPosition;
layout(std140, binding = 2) uniform Scene {
  mat4 uMatrix;
  vec4 uEye;
  vec4 uPlane;
};

out vec3 vPosition;
out vec3 vRay;

void main() {
  vPosition = aPosition;
  vRay = aPosition - uEye.xyz;
  gl_Position = uMatrix * vec4(aPosition, 1.0);
}
)",
                                      R"(#version 420 core
layout(std140, binding = 2) uniform Scene {
  mat4 uMatrix;
  vec4 uEye;
  vec4 uPlane;
};
layout(binding = 0) uniform sampler3D uCoral;
layout(binding = 1) uniform sampler1D uTransfer;

in vec3 vPosition;
in vec3 vRay;
layout(location = 0) out vec4 oColour;

const float kStep = 0.0175;

void main() {
  vec3 dir = normalize(vRay);
  vec3 far = mix(-vPosition, 1.0 - vPosition, greaterThan(dir, vec3(0.0))) / dir;
  float leave = min(far.x, min(far.y, far.z));

  vec4 dst = vec4(0.0);
  for (float t = 0.0; t < leave; t += kStep) {
    vec3 p = vPosition + t * dir;
    if (dot(uPlane, vec4(p, 1.0)) < 0.0) continue;
    vec4 src = texture(uTransfer, texture(uCoral, p).r);
    src.rgb *= src.a;
    dst += (1.0 - dst.a) * src;
  }
  oColour = dst;
}
)");
            const VertexBuffer vertices(canvas);
            const Field coral = [](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.47F, c = z - 0.5F;
              const float away = std::sqrt(a * a + b * b + c * c);
              const float grooves =
                  std::sin(12 * x + 2.2F * std::cos(9 * z + 1)) * std::cos(10 * y + 1.8F * std::sin(8 * x)) +
                  0.5F * std::sin(11 * z - 6 * y);
              return std::clamp((0.5F + 0.24F * grooves) * std::clamp(2.6F - 4 * away, 0.0F, 1.0F) + 0.07F * y,
                                0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float stone = std::clamp((at - 0.28F) / 0.5F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(235 - 60 * at),
                               static_cast<std::uint8_t>(70 + 130 * stone),
                               static_cast<std::uint8_t>(130 + 60 * std::sin(5 * at)),
                               static_cast<std::uint8_t>(std::lround(3 * at + 38 * stone))});
            }
            upload_volume(canvas, 0, sampled(48, 60, 52, coral), {.texel = Texel::unsigned16});
            upload_table_1d(canvas, 1, table);
            struct Scene {
              Matrix matrix;
              std::array<float, 4> eye, plane;
            };
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, sizeof(Scene), nullptr, GL_DYNAMIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 2, block);
            return [&canvas, program, vertices, block](int frame) {
              const Camera camera =
                  camera_at({.azimuth = 100, .elevation = -16, .distance = 2.4F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              // What lies before it, seen from about the eye's place at frame 18, is left out.
              const Vector normal = normalized({-0.7F, 0.35F, 0.6F});
              const float at_plane = frame < 14 ? -2.0F : dot(normal, {0.5F, 0.5F, 0.5F});
              const Scene scene{.matrix = camera.clip_from_object(),
                                .eye = {camera.eye.x, camera.eye.y, camera.eye.z, 1},
                                .plane = {normal.x, normal.y, normal.z, -at_plane}};
              canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
              canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(scene), &scene);
              canvas.begin(0.05F, 0.1F, 0.16F);
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
