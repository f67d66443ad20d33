// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario lit_in_view_space() {
  return {
      .sentence =
          "The light is at the origin of view space, where normals are taken to and turned by faceforward(); a "
          "1-D table, the camera turns by 5 degrees a frame.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 u_modelView;
uniform mat4 u_projection;
out vec3 v_texture;
out vec3 v_camera;
void main() {
  v_texture = position;
  v_camera = (inverse(u_modelView) * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
  gl_Position = u_projection * u_modelView * vec4(position, 1.0);
}
)",
                                  R"(#version 330 core
in vec3 v_texture;
in vec3 v_camera;
out vec4 f_color;
uniform sampler3D s_volume;
uniform sampler1D s_transfer;
uniform mat4 u_modelView;
uniform float u_step;
uniform float u_voxel;

struct Material { float ambient, diffuse, specular, shininess; };
const Material material = Material(0.18, 0.62, 0.3, 40.0);

vec3 centralDifference(vec3 p) {
  vec3 result = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    vec3 offset = vec3(0.0);
    offset[axis] = u_voxel;
    result[axis] = texture(s_volume, p + offset).r - texture(s_volume, p - offset).r;
  }
  return result;
}

vec3 illuminate(vec3 albedo, vec3 p) {
  mat3 normalMatrix = transpose(inverse(mat3(u_modelView)));
  vec3 n = normalMatrix * centralDifference(p);
  float magnitude = length(n);
  if (magnitude > 1e-6) n /= magnitude; else n = vec3(0.0);
  vec3 toEye = -normalize((u_modelView * vec4(p, 1.0)).xyz);
  n = faceforward(n, -toEye, n);
  vec3 toLight = toEye;
  vec3 halfway = normalize(toLight + toEye);
  float kd = max(dot(n, toLight), 0.0);
  float ks = pow(max(dot(n, halfway), 0.0), material.shininess);
  return albedo * (material.ambient + material.diffuse * kd) + material.specular * ks;
}

void main() {
  vec3 dir = normalize(v_texture - v_camera);
  vec3 tEnd = max(-v_texture / dir, (1.0 - v_texture) / dir);
  float len = min(tEnd.x, min(tEnd.y, tEnd.z));
  f_color = vec4(0.0);
  for (float t = 0.0; t <= len; t += u_step) {
    vec3 p = v_texture + t * dir;
    vec4 c = texture(s_transfer, texture(s_volume, p).r);
    if (c.a == 0.0) continue;
    float weight = (1.0 - f_color.a) * c.a;
    f_color.rgb += weight * illuminate(c.rgb, p);
    f_color.a += weight;
  }
}
)");
        const VertexBuffer box(canvas);
        // A heart's chambers: two hollow eggs that touch, and a vessel that leaves through the lid.
        const Field field = [](float x, float y, float z) {
          const auto egg = [&](float cx, float cy, float cz, float radius, float amount) {
            const float a = x - cx, b = 0.8F * (y - cy), c = 1.15F * (z - cz);
            const float off = std::sqrt(a * a + b * b + c * c) - radius;
            return 1 - amount * std::exp(-260 * off * off);
          };
          const float u = x - 0.45F - 0.1F * std::sin(5 * y), w = z - 0.55F;
          const float above = std::max(y - 0.35F, 0.0F);
          const float vessel = 0.85F * std::exp(-130 * (u * u + w * w)) * (1 - std::exp(-40 * above * above));
          const float left = egg(0.36F, 0.42F, 0.5F, 0.21F, 0.55F),
                      right = egg(0.66F, 0.45F, 0.48F, 0.18F, 0.6F);
          return 1 - left * right * (1 - vessel);
        };
        std::vector<Colour> transfer;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float wall = std::exp(-std::pow((at - 0.42F) / 0.11F, 2.0F));
          const float blood = std::exp(-std::pow((at - 0.78F) / 0.13F, 2.0F));
          transfer.push_back({static_cast<std::uint8_t>(110 + 70 * at),
                              static_cast<std::uint8_t>(150 - 100 * at),
                              static_cast<std::uint8_t>(60 + 60 * wall),
                              static_cast<std::uint8_t>(std::lround(26 * wall + 60 * blood))});
        }
        upload_volume(canvas, 0, sampled(80, field));
        upload_table_1d(canvas, 1, transfer);
        return [&canvas, program, box](int frame) {
          const Camera camera = camera_at({.azimuth = 10, .elevation = -18, .degrees_each_frame = 5}, frame);
          canvas.begin(0.2F, 0.2F, 0.22F);
          program.use();
          program.set("s_volume", 0);
          program.set("s_transfer", 1);
          program.set("u_modelView", camera.view);
          program.set("u_projection", camera.projection);
          program.set("u_step", 0.018F);
          program.set("u_voxel", 1 / 80.0F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          box.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
