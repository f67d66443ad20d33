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

Scenario block_two_blocks() {
  return {
      .sentence =
          "A knotted cord of 16 bits in GLSL 4.20. One block has the ray's entry and its direction, another "
          "one how far the entry lies from a plane of a uniform and how that changes along the ray; samples "
          "beyond the plane are left out. It misses the box until frame 10, and moves on at frame 18.",
      .expectation = Expectation::either,
      .key_frames = {10, 18},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 a_corner;
uniform mat4 u_clip;
uniform vec3 u_eye;
uniform vec4 u_plane;

out CutBlock {
  float at_entry;
  float per_length;
} cut_out;

out RayBlock {
  vec3 toward;
  vec3 entry;
} ray_out;

void main() {
  ray_out.entry = a_corner;
  ray_out.toward = a_corner - u_eye;
  cut_out.at_entry = dot(u_plane, vec4(a_corner, 1.0));
  cut_out.per_length = dot(u_plane.xyz, a_corner - u_eye);
  gl_Position = u_clip * vec4(a_corner, 1.0);
}
)",
                                  R"(#version 420 core
layout(binding = 0) uniform sampler3D s_field;
layout(binding = 1) uniform sampler2D s_lut;
uniform float u_spacing;

in RayBlock {
  vec3 toward;
  vec3 entry;
} ray;

in CutBlock {
  float at_entry;
  float per_length;
} cut;

layout(location = 0) out vec4 o_colour;

void main() {
  float scale = 1.0 / length(ray.toward);
  vec3 unit = ray.toward * scale;
  float slope = cut.per_length * scale;
  vec3 walls = (step(vec3(0.0), unit) - ray.entry) / unit;
  float reach = min(min(walls.x, walls.y), walls.z);

  vec3 light = vec3(0.0);
  float passed = 1.0;
  for (float t = 0.0; t < reach; t += u_spacing) {
    if (cut.at_entry + t * slope < 0.0) continue;
    vec4 m = texture(s_lut, vec2(texture(s_field, ray.entry + t * unit).r, 0.5));
    light += passed * m.a * m.rgb;
    passed *= 1.0 - m.a;
  }
  o_colour = vec4(light, 1.0 - passed);
}
)");
        const VertexBuffer vertices(canvas);
        const Field cord = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.48F, c = z - 0.52F;
          const float around = std::atan2(b, a), away = std::sqrt(a * a + b * b);
          // Three turns of the cord's section for two around the middle.
          const float twist = 1.5F * around;
          float sum = 0.12F + 0.07F * std::sin(8 * x - 6 * y + 9 * z);
          for (const float side : {-1.0F, 1.0F}) {
            const float u = away - 0.29F - 0.11F * side * std::cos(twist);
            const float v = c - 0.14F * side * std::sin(twist);
            sum += (0.8F + 0.12F * std::sin(12 * around)) * std::exp(-90 * (u * u + v * v));
          }
          return std::clamp(sum, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float fibre = std::clamp((at - 0.25F) / 0.4F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(60 + 190 * fibre),
                           static_cast<std::uint8_t>(90 + 80 * std::sin(4 * at + 0.5F)),
                           static_cast<std::uint8_t>(170 - 140 * fibre * at),
                           static_cast<std::uint8_t>(std::lround(1 + 5 * at + 34 * fibre * fibre))});
        }
        upload_volume(canvas, 0, sampled(56, 56, 44, cord), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("u_spacing", 0.016F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = -20, .elevation = 18, .distance = 2.3F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector normal = normalized({-0.6F, -0.5F, -0.4F});
          const float depth = frame < 10 ? -0.1F : frame < 18 ? 0.6F : 0.8F;  // of what is left out
          canvas.begin(0.1F, 0.16F, 0.12F);
          program.use();
          program.set("u_clip", camera.clip_from_object());
          program.set("u_eye", camera.eye);
          canvas.gl.Uniform4f(program.location("u_plane"), normal.x, normal.y, normal.z,
                              -dot(normal, {1, 1, 1}) - depth);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
