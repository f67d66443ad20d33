// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_foam_reflect_block() {
  return {.sentence =
              "A foam of 96 x 64 x 80 bytes, marched in units of texels, Phong's light by reflect(), GLSL "
              "4.30 with explicit bindings and the camera in a uniform block; 64 float colours in a 2-D "
              "texture.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 corner;
layout(std140, binding = 3) uniform ViewBlock {
  mat4 clipFromVoxel;
  vec4 eyeVoxel;
  vec4 gridSize;
} view;
layout(location = 0) out vec3 voxelPos;
void main()
{
  voxelPos = corner * view.gridSize.xyz;
  gl_Position = view.clipFromVoxel * vec4(voxelPos, 1.0);
}
)",
                                      R"(#version 430 core
layout(std140, binding = 3) uniform ViewBlock {
  mat4 clipFromVoxel;
  vec4 eyeVoxel;
  vec4 gridSize;
} view;
layout(binding = 0) uniform sampler3D grid;
layout(binding = 1) uniform sampler2D palette;
layout(location = 0) in vec3 voxelPos;
layout(location = 0) out vec4 result;

const float kStep = 0.9;
const vec3 kLight = vec3(0.15, 0.65, 0.3);  // ambient, diffuse, specular

float fetch(vec3 x) { return texture(grid, x / view.gridSize.xyz).r; }

vec3 grad(vec3 x)
{
  const vec2 e = vec2(1.0, 0.0);
  return 0.5 * vec3(fetch(x + e.xyy) - fetch(x - e.xyy),
                    fetch(x + e.yxy) - fetch(x - e.yxy),
                    fetch(x + e.yyx) - fetch(x - e.yyx));
}

vec3 phong(vec3 albedo, vec3 n, vec3 w)
{
  float diffuse = max(dot(n, -w), 0.0);
  vec3 mirrored = reflect(w, n);
  float highlight = diffuse > 0.0 ? pow(clamp(dot(mirrored, -w), 0.0, 1.0), 18.0) : 0.0;
  return albedo * (kLight.x + kLight.y * diffuse) + vec3(kLight.z * highlight);
}

void main()
{
  const vec3 w = normalize(voxelPos - view.eyeVoxel.xyz);
  const vec3 invW = 1.0 / w;
  const vec3 tA = -voxelPos * invW;
  const vec3 tB = (view.gridSize.xyz - voxelPos) * invW;
  const vec3 tFar = max(tA, tB);
  const int n = int(min(min(tFar.x, tFar.y), tFar.z) / kStep) + 1;

  float transmittance = 1.0;
  vec3 radiance = vec3(0.0);
  for (int k = 0; k < n; ++k)
  {
    const vec3 x = voxelPos + (float(k) * kStep) * w;
    const vec4 m = texture(palette, vec2(fetch(x), 0.0));
    const vec3 g = -grad(x);
    const float len = length(g);
    const vec3 normal = len > 1.0e-6 ? g / len : vec3(0.0);
    radiance += transmittance * m.a * phong(m.rgb, normal, w);
    transmittance *= 1.0 - m.a;
    if (transmittance < 0.004)
      break;
  }
  result = vec4(radiance, 1.0 - transmittance);
}
)");
            const VertexBuffer vertices(canvas);
            const Field foam = [](float x, float y, float z) {
              const float u = 13 * x + 0.4F, v = 9 * y + 0.9F, w = 11 * z;
              const float diamond =
                  std::sin(u) * std::sin(v) * std::sin(w) + std::sin(u) * std::cos(v) * std::cos(w) +
                  std::cos(u) * std::sin(v) * std::cos(w) + std::cos(u) * std::cos(v) * std::sin(w);
              return std::clamp(0.5F + 0.28F * diamond + 0.1F * (y - z), 0.0F, 1.0F);
            };
            upload_volume(canvas, 0, sampled(96, 64, 80, foam));
            std::vector<float> palette;
            for (int i = 0; i < 64; ++i) {
              const float at = static_cast<float>(i) / 63;
              const float thick = std::clamp((at - 0.58F) / 0.15F, 0.0F, 1.0F);
              palette.insert(palette.end(), {0.9F - 0.6F * thick, 0.5F + 0.35F * at, 0.25F + 0.6F * thick,
                                             0.3F * thick * thick + 0.004F});
            }
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.BindTexture(GL_TEXTURE_2D, name);
            filter_linearly(canvas, GL_TEXTURE_2D);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 1, 0, GL_RGBA, GL_FLOAT, palette.data());
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, 24 * sizeof(float), nullptr, GL_DYNAMIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 3, block);
            return [&canvas, program, vertices, block](int frame) {
              constexpr Vector size{96, 64, 80};
              const Orbit orbit{.azimuth = 250, .elevation = 33, .distance = 2.3F, .degrees_each_frame = 1};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const Vector origin = Vector{0.5F, 0.5F, 0.5F} - 1 / 192.0F * size;
              const Matrix model{1 / 96.0F, 0, 0,         0, 0,        1 / 96.0F, 0,        0,
                                 0,         0, 1 / 96.0F, 0, origin.x, origin.y,  origin.z, 1};
              const Matrix clip = camera.clip_from_object() * model;
              const Vector eye = 96.0F * (camera.eye - origin);
              std::array<float, 24> values{};
              std::copy(clip.begin(), clip.end(), values.begin());
              values[16] = eye.x, values[17] = eye.y, values[18] = eye.z, values[19] = 1;
              values[20] = size.x, values[21] = size.y, values[22] = size.z, values[23] = 1;
              canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
              canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(values), values.data());
              canvas.begin(0.12F, 0.1F, 0.1F);
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
