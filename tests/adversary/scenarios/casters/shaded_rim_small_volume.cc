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

Scenario shaded_rim_small_volume() {
  return {.sentence =
              "Only 24 x 32 x 28 bytes, stretched to a cube: drops with a bright rim where they turn away, "
              "gradients by a loop over the axes, GLSL 3.30, one row of a sheet of colour maps.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
in vec3 position;
uniform mat4 viewProj;
uniform vec3 camPos;
out vec3 rayEntry;
out vec3 rayDirUnnormalized;
void main() {
  rayEntry = position;
  rayDirUnnormalized = position - camPos;
  gl_Position = viewProj * vec4(position, 1.0);
}
)",
                                      R"(#version 330 core
in vec3 rayEntry;
in vec3 rayDirUnnormalized;
uniform sampler3D density;
uniform sampler2D colormaps;
uniform int colormap;
uniform float dt;
uniform float opacityScale;
out vec4 outColor;

const float H = 1.0 / 28.0;

vec3 gradientAt(vec3 p) {
  vec3 g = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    vec3 e = vec3(0.0);
    e[axis] = H;
    g[axis] = texture(density, p + e).r - texture(density, p - e).r;
  }
  return g;
}

float rimLit(float facing) {
  float rim = 1.0 - facing;
  return 0.2 + 0.45 * facing + 0.55 * rim * rim * rim;
}

void main() {
  vec3 d = normalize(rayDirUnnormalized);
  vec3 tx = (mix(vec3(0.0), vec3(1.0), greaterThan(d, vec3(0.0))) - rayEntry) / d;
  float tmax = min(tx.x, min(tx.y, tx.z));
  float row = (float(colormap) + 0.5) / float(textureSize(colormaps, 0).y);
  vec4 acc = vec4(0.0);
  for (float t = 0.5 * dt; t < tmax; t += dt) {
    vec3 p = rayEntry + d * t;
    float v = texture(density, p).r;
    vec4 c = texture(colormaps, vec2(v, row));
    c.a *= opacityScale;
    vec3 g = gradientAt(p);
    float facing = abs(dot(g, d)) * inversesqrt(max(dot(g, g), 1e-10));
    c.rgb *= rimLit(facing);
    acc += vec4(c.rgb * c.a, c.a) * (1.0 - acc.a);
  }
  outColor = acc;
}
)");
            const VertexBuffer vertices(canvas);
            const Field drops = [](float x, float y, float z) {
              const auto drop = [&](float u, float v, float w, float size) {
                const float square = (x - u) * (x - u) + (y - v) * (y - v) + (z - w) * (z - w);
                return std::exp(-square / (size * size));
              };
              return std::min(
                  1.0F, 0.9F * drop(0.35F, 0.4F, 0.6F, 0.22F) + 0.8F * drop(0.68F, 0.62F, 0.4F, 0.2F) +
                            0.7F * drop(0.3F, 0.75F, 0.3F, 0.15F) + 0.7F * drop(0.72F, 0.25F, 0.7F, 0.16F));
            };
            // Rows: grey, fire, ice, spectrum.
            std::vector<Colour> sheet;
            for (int row = 0; row < 4; ++row)
              for (int i = 0; i < 64; ++i) {
                const float at = static_cast<float>(i) / 63;
                const auto level = [](float value) {
                  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
                };
                const float alpha = 0.03F * at + 0.3F * std::exp(-std::pow((at - 0.42F) / 0.12F, 2.0F));
                if (row == 0) sheet.push_back({level(at), level(at), level(at), level(alpha)});
                if (row == 1)
                  sheet.push_back({level(3 * at), level(3 * at - 0.6F), level(3 * at - 1.4F), level(alpha)});
                if (row == 2)
                  sheet.push_back({level(1.6F * at - 0.4F), level(0.35F + 0.6F * at), level(1.1F - 0.2F * at),
                                   level(alpha)});
                if (row == 3)
                  sheet.push_back({level(std::abs(4 * at - 2) - 0.5F), level(1.5F - std::abs(4 * at - 2)),
                                   level(1.4F - 3 * at), level(alpha)});
              }
            upload_volume(canvas, 0, sampled(24, 32, 28, drops));
            upload_table_2d(canvas, 1, sheet, 4);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 140, .elevation = -18, .distance = 2.3F, .degrees_each_frame = 3};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.05F, 0.05F, 0.12F);
              program.use();
              program.set("viewProj", camera.clip_from_object());
              program.set("camPos", camera.eye);
              program.set("density", 0);
              program.set("colormaps", 1);
              program.set("colormap", 1);
              program.set("dt", 0.02F);
              program.set("opacityScale", 1.5F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
