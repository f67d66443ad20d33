// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario gleam_metaballs_texture_offset() {
  return {.sentence =
              "Metaballs of 40 x 48 x 36 floats in GLSL 3.30: colour and opacity by formula, gradient by "
              "textureOffset, half Lambert squared and no other light.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 a_corner;
uniform mat4 u_viewProjection;
out vec3 v_uvw;
void main() {
  v_uvw = a_corner;
  gl_Position = u_viewProjection * vec4(a_corner, 1.0);
}
)",
                                      R"(#version 330 core
in vec3 v_uvw;
layout(location = 0) out vec4 o_color;
uniform sampler3D u_potential;
uniform vec3 u_cameraPosition;

#define STEP_LENGTH 0.018
#define PI 3.14159265

vec3 palette(float t) {
  return 0.5 + 0.5 * cos(2.0 * PI * (0.45 * t + vec3(0.0, 0.3, 0.62)));
}

float opacity(float t) {
  return 0.004 + 0.13 * smoothstep(0.35, 1.3, t);
}

vec3 gradient(vec3 uvw) {
  float x0 = textureOffset(u_potential, uvw, ivec3(-1, 0, 0)).r;
  float x1 = textureOffset(u_potential, uvw, ivec3(1, 0, 0)).r;
  float y0 = textureOffset(u_potential, uvw, ivec3(0, -1, 0)).r;
  float y1 = textureOffset(u_potential, uvw, ivec3(0, 1, 0)).r;
  float z0 = textureOffset(u_potential, uvw, ivec3(0, 0, -1)).r;
  float z1 = textureOffset(u_potential, uvw, ivec3(0, 0, 1)).r;
  return 0.5 * vec3(x1 - x0, y1 - y0, z1 - z0) * vec3(textureSize(u_potential, 0));
}

float halfLambert(vec3 g, vec3 toEye) {
  float wrapped = 0.5 - 0.5 * dot(g, toEye) * inversesqrt(max(dot(g, g), 1e-12));
  return wrapped * wrapped;
}

void main() {
  vec3 ray = normalize(v_uvw - u_cameraPosition);
  vec3 reciprocal = 1.0 / ray;
  vec3 far = max(-v_uvw * reciprocal, (1.0 - v_uvw) * reciprocal);
  float t_max = min(far.x, min(far.y, far.z));

  vec4 acc = vec4(0.0);
  float t = 0.0;
  while (t < t_max) {
    vec3 uvw = v_uvw + t * ray;
    float v = texture(u_potential, uvw).r;
    float a = opacity(v);
    vec3 c = palette(v) * halfLambert(gradient(uvw), -ray);
    acc.rgb += (1.0 - acc.a) * a * c;
    acc.a += (1.0 - acc.a) * a;
    if (acc.a > 0.995) break;
    t += STEP_LENGTH;
  }
  o_color = acc;
}
)");
            const VertexBuffer vertices(canvas);
            const Field potential = [](float x, float y, float z) {
              const auto ball = [&](float cx, float cy, float cz, float size) {
                const float d = (x - cx) * (x - cx) + (y - cy) * (y - cy) + (z - cz) * (z - cz);
                return std::exp(-d / (size * size));
              };
              return ball(0.3F, 0.35F, 0.4F, 0.22F) + 1.2F * ball(0.66F, 0.42F, 0.3F, 0.2F) +
                     0.9F * ball(0.42F, 0.7F, 0.68F, 0.25F) + 1.4F * ball(0.75F, 0.72F, 0.7F, 0.15F) +
                     0.3F * ball(0.5F, 0.2F, 0.85F, 0.3F) + 0.15F * x + 0.08F * std::sin(11 * y + 4 * z);
            };
            upload_volume(canvas, 2, sampled(40, 48, 36, potential), {.texel = Texel::float32});
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 205, .elevation = -16, .distance = 2.7F, .degrees_each_frame = -1};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.22F, 0.22F, 0.24F);
              program.use();
              program.set("u_potential", 2);
              program.set("u_viewProjection", camera.clip_from_object());
              program.set("u_cameraPosition", camera.eye);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
