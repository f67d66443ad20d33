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

Scenario place_reef_quad_flies_in() {
  return {
      .sentence =
          "A reef of 48 x 48 x 32 floats in GLSL 4.50: two triangles over the window, rays from the inverse of "
          "the "
          "matrix, a box turned and stretched by its model matrix, steps of one length in the world. The eye "
          "flies "
          "in and is inside from about frame 20 on.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 corner;
layout(location = 0) out vec2 ndc;
void main() {
  ndc = corner.xy;
  gl_Position = vec4(corner.xy, 0.0, 1.0);
}
)",
                                  R"(#version 450 core
layout(binding = 0) uniform sampler3D reef;
layout(binding = 1) uniform sampler2D colormap;
uniform mat4 world_from_clip;
uniform mat4 model_from_world;
uniform vec3 camera_world;
uniform float ds;
layout(location = 0) in vec2 ndc;
layout(location = 0) out vec4 pixel;

struct Ray { vec3 o; vec3 d; };
struct Span { float enter; float leave; };

Span hit(in Ray r, in vec3 lower, in vec3 upper) {
  vec3 a = (lower - r.o) / r.d;
  vec3 b = (upper - r.o) / r.d;
  vec3 n = min(a, b), f = max(a, b);
  return Span(max(max(n.x, n.y), n.z), min(min(f.x, f.y), f.z));
}

void main() {
  vec4 far = world_from_clip * vec4(ndc, 1.0, 1.0);
  vec3 dir_world = normalize(far.xyz / far.w - camera_world);
  Ray ray;
  ray.o = (model_from_world * vec4(camera_world, 1.0)).xyz;
  ray.d = mat3(model_from_world) * dir_world;  // of unit length in the world
  Span s = hit(ray, vec3(0.0), vec3(1.0));
  float enter = max(s.enter, 0.0);
  if (s.leave <= enter) { pixel = vec4(0.0); return; }
  vec4 sum = vec4(0.0);
  float t = enter + 0.5 * ds;
  while (t < s.leave && sum.a < 0.995) {
    vec4 c = texture(colormap, vec2(textureLod(reef, ray.o + t * ray.d, 0.0).r, 0.5));
    c.a = 1.0 - exp(-3.0 * c.a * ds / 0.02);
    sum += (1.0 - sum.a) * vec4(c.a * c.rgb, c.a);
    t += ds;
  }
  pixel = sum;
}
)");
        const VertexBuffer screen(canvas);
        const Field reef = [](float x, float y, float z) {
          const float ground =
              0.35F + 0.12F * std::sin(9 * x + 2) * std::cos(8 * y) + 0.05F * std::sin(22 * x * y);
          const float corals = 0.3F * std::sin(15 * x + 4 * z) * std::sin(14 * y - 3 * z);
          return std::clamp(0.5F + 1.5F * (ground - z) + corals * z * 1.5F, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float coral = std::exp(-std::pow((at - 0.55F) / 0.1F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(40 + 190 * coral),
                           static_cast<std::uint8_t>(90 + 110 * at), static_cast<std::uint8_t>(210 - 120 * at),
                           static_cast<std::uint8_t>(std::lround(1 + 14 * coral + 10 * at * at))});
        }
        upload_volume(canvas, 0, sampled(48, 48, 32, reef), {.texel = Texel::float32});
        upload_table_2d(canvas, 1, table);
        return [&canvas, program, screen](int frame) {
          const float distance = 2.5F - 0.08F * static_cast<float>(frame);
          const Camera camera =
              camera_at({.azimuth = 200, .elevation = 25, .distance = distance, .degrees_each_frame = 2}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          // The camera's axes are orthonormal, and the projection is symmetric: inverses by hand.
          const Matrix& p = camera.projection;
          const Matrix& v = camera.view;
          const Matrix world_from_view{v[0], v[4], v[8],  0, v[1],         v[5],         v[9],         0,
                                       v[2], v[6], v[10], 0, camera.eye.x, camera.eye.y, camera.eye.z, 1};
          const Matrix view_from_clip{1 / p[0], 0, 0, 0,         0, 1 / p[5], 0,  0,
                                      0,        0, 0, 1 / p[14], 0, 0,        -1, p[10] / p[14]};
          const float c = std::cos(0.5F), s = std::sin(0.5F);
          const Matrix to_middle{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5F, 0.5F, 0.5F, 1};
          const Matrix turn{1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, 0, 1};
          const Matrix shrink{1 / 1.1F, 0, 0, 0, 0, 1 / 0.9F, 0, 0, 0, 0, 1 / 0.7F, 0, 0, 0, 0, 1};
          const Matrix from_middle{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.5F, -0.5F, 1};
          canvas.begin(0.02F, 0.1F, 0.15F);
          program.use();
          program.set("world_from_clip", world_from_view * view_from_clip);
          program.set("model_from_world", to_middle * shrink * turn * from_middle);
          program.set("camera_world", camera.eye);
          program.set("ds", 0.02F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          screen.draw(std::array<Vector, 4>{Vector{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                      GL_TRIANGLE_STRIP);
        };
      }};
}

}  // namespace adversary::casters
