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

Scenario wave_polish_dulls_with_distance() {
  return {
      .sentence =
          "Pebbles of 40 x 40 x 40 bytes in GLSL 4.00: diffuse light from the eye is the same at all "
          "distances, "
          "but the highlight loses 45 % of its strength for each unit that the sample is farther from the eye; "
          "gradients of one texel with inversesqrt(), rays end at 0.9, the table is edited at frame 12.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 400 core
in vec3 position;
uniform mat4 u_mvp;
uniform vec4 u_eye;
out vec3 v_direction;

void main() {
  v_direction = position * u_eye.w - u_eye.xyz;
  gl_Position = u_mvp * vec4(position, 1.0);
}
)",
                                  R"(#version 400 core
uniform sampler3D u_pebbles;
uniform sampler2D u_colors;
uniform vec4 u_eye;
uniform float u_ds;
uniform float u_shininess;
uniform float u_dulling;

in vec3 v_direction;
out vec4 f_color;

float at(vec3 p) {
  return texture(u_pebbles, p).r;
}

vec3 unitGradient(vec3 p) {
  const ivec3 X = ivec3(1, 0, 0);
  vec3 d = 1.0 / vec3(textureSize(u_pebbles, 0));
  vec3 g = vec3(at(p + d * X.xyy) - at(p - d * X.xyy),
                at(p + d * X.yxy) - at(p - d * X.yxy),
                at(p + d * X.yyx) - at(p - d * X.yyx));
  return inversesqrt(dot(g, g) + 1e-6) * g;
}

void main() {
  vec3 eye = u_eye.xyz;
  vec3 dir = normalize(v_direction);
  vec3 k = 1.0 / dir;
  vec3 m = (0.5 - eye) * k;
  vec3 r = 0.5 * abs(k);
  float t0 = max(max(m.x - r.x, m.y - r.y), max(m.z - r.z, 0.0));
  float t1 = min(min(m.x + r.x, m.y + r.y), m.z + r.z);

  vec4 sum = vec4(0.0);
  for (float t = t0; t < t1; t += u_ds) {
    vec3 p = eye + t * dir;
    vec4 c = texture(u_colors, vec2(at(p), 0.5));
    float facing = max(dot(unitGradient(p), dir), 0.0);
    float polish = clamp(1.0 - u_dulling * (t - 1.5), 0.0, 1.0);
    vec3 lit = c.rgb * (0.25 + 0.45 * facing) + 0.5 * polish * pow(facing, u_shininess);
    sum += (1.0 - sum.a) * vec4(lit * c.a, c.a);
    if (sum.a >= 0.9) break;
  }
  f_color = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field pebbles = [](float x, float y, float z) {
          const float a = std::sin(9.5F * x + 0.4F), b = std::sin(8.5F * y + 1.1F), c = std::sin(9 * z + 0.7F);
          return std::clamp(0.35F + 0.5F * a * b * c + 0.15F * std::sin(4 * x + 3 * y - 5 * z), 0.0F, 1.0F);
        };
        const auto colours_of = [](bool mossy) {
          std::vector<Colour> colours;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float stone = std::clamp((at - (mossy ? 0.38F : 0.45F)) / 0.22F, 0.0F, 1.0F);
            colours.push_back({static_cast<std::uint8_t>(mossy ? 70 + 60 * at : 190 - 40 * at),
                               static_cast<std::uint8_t>(mossy ? 160 - 30 * at : 150 - 60 * at),
                               static_cast<std::uint8_t>(mossy ? 60 + 120 * at : 110 + 60 * at),
                               static_cast<std::uint8_t>(std::lround(2 + 42 * stone))});
          }
          return colours;
        };
        upload_volume(canvas, 0, sampled(40, pebbles));
        upload_table_2d(canvas, 1, colours_of(false));
        program.use();
        program.set("u_pebbles", 0);
        program.set("u_colors", 1);
        program.set("u_ds", 0.02F);
        program.set("u_shininess", 10.0F);
        program.set("u_dulling", 0.45F);
        return [&canvas, program, vertices, colours_of](int frame) {
          if (frame == 12) {
            const auto colours = colours_of(true);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          const Orbit orbit{.azimuth = 170, .elevation = 33, .distance = 2.3F, .degrees_each_frame = 1.3F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.14F, 0.12F, 0.1F);
          program.use();
          program.set("u_mvp", camera.clip_from_object());
          canvas.gl.Uniform4f(program.location("u_eye"), camera.eye.x, camera.eye.y, camera.eye.z, 1);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
