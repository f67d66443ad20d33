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

Scenario guarded_normal_added() {
  return {
      .sentence =
          "A cushion star of 28 x 48 x 36 bytes in GLSL 1.20: light from the eye on both sides of the "
          "surface, a white highlight, and normals that are the difference of two lookups divided by "
          "its length plus 0.002.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 120
attribute vec3 position;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
varying vec3 pos;

void main(void)
{
  pos = position;
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
}
)",
                                  R"(#version 120
uniform sampler3D tex3d;
uniform sampler1D transfer;
uniform vec3 eyePos;
uniform vec3 texel;
uniform float delta;
varying vec3 pos;

vec3 normalOf(vec3 p)
{
  vec3 gradient;
  gradient.x = texture3D(tex3d, p + vec3(texel.x, 0.0, 0.0)).r
             - texture3D(tex3d, p - vec3(texel.x, 0.0, 0.0)).r;
  gradient.y = texture3D(tex3d, p + vec3(0.0, texel.y, 0.0)).r
             - texture3D(tex3d, p - vec3(0.0, texel.y, 0.0)).r;
  gradient.z = texture3D(tex3d, p + vec3(0.0, 0.0, texel.z)).r
             - texture3D(tex3d, p - vec3(0.0, 0.0, texel.z)).r;
  return gradient / (length(gradient) + 0.002);
}

void main(void)
{
  vec3 rayDir = normalize(pos - eyePos);
  vec3 invRay = 1.0 / rayDir;
  vec3 toMin = (vec3(0.0) - eyePos) * invRay;
  vec3 toMax = (vec3(1.0) - eyePos) * invRay;
  vec3 near = min(toMin, toMax);
  vec3 far = max(toMin, toMax);
  float tnear = max(0.0, max(near.x, max(near.y, near.z)));
  float tfar = min(far.x, min(far.y, far.z));

  vec4 dest = vec4(0.0);
  float t = tnear;
  while (t < tfar)
  {
    vec3 p = eyePos + rayDir * t;
    vec4 color = texture1D(transfer, texture3D(tex3d, p).r);
    vec3 view = normalize(eyePos - p);
    float facing = abs(dot(normalOf(p), view));
    color.rgb = color.rgb * (0.25 + 0.65 * facing) + vec3(0.2 * pow(facing, 12.0));
    color.rgb *= color.a;
    dest = dest + (1.0 - dest.a) * color;
    t += delta;
  }
  gl_FragColor = dest;
}
)");
        const VertexBuffer vertices(canvas);
        const Field star = [](float x, float y, float z) {
          const float a = x - 0.52F, b = y - 0.46F, c = z - 0.5F;
          const float arms = 0.3F + 0.08F * std::cos(5 * std::atan2(c, a) + 1);
          const float away = std::sqrt(a * a + 2.2F * b * b + c * c);
          return std::clamp(0.5F + 1.6F * (arms - away) + 0.04F * std::sin(9 * x + 7 * y), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float skin = std::clamp((at - 0.25F) / 0.4F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(210 - 40 * skin), static_cast<std::uint8_t>(70 + 80 * at),
                           static_cast<std::uint8_t>(60 + 130 * skin * skin),
                           static_cast<std::uint8_t>(std::lround(36 * skin * skin * (3 - 2 * skin) + 2))});
        }
        upload_volume(canvas, 0, sampled(28, 48, 36, star));
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("tex3d", 0);
        program.set("transfer", 1);
        program.set("texel", Vector{1 / 28.0F, 1 / 48.0F, 1 / 36.0F});
        program.set("delta", 0.02F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 75, .elevation = 40, .distance = 2.5F, .degrees_each_frame = 1.2F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.08F, 0.14F, 0.2F);
          program.use();
          program.set("projectionMatrix", camera.projection);
          program.set("modelViewMatrix", camera.view);
          program.set("eyePos", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
