// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario gleam_marble_glsl_120() {
  return {.sentence =
              "Marble of 48 x 48 x 48 bytes in GLSL 1.20: immediate mode, the eye from "
              "gl_ModelViewMatrixInverse, a "
              "1-D table, differences at a constant distance, one-sided Blinn-Phong without ambient light.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volumeTexture;
uniform sampler1D transferFunction;
uniform float stepSize;

const float DELTA = 0.02;

vec3 computeNormal(vec3 p)
{
  vec3 s1, s2;
  s1.x = texture3D(volumeTexture, p - vec3(DELTA, 0.0, 0.0)).x;
  s2.x = texture3D(volumeTexture, p + vec3(DELTA, 0.0, 0.0)).x;
  s1.y = texture3D(volumeTexture, p - vec3(0.0, DELTA, 0.0)).x;
  s2.y = texture3D(volumeTexture, p + vec3(0.0, DELTA, 0.0)).x;
  s1.z = texture3D(volumeTexture, p - vec3(0.0, 0.0, DELTA)).x;
  s2.z = texture3D(volumeTexture, p + vec3(0.0, 0.0, DELTA)).x;
  vec3 N = s1 - s2;
  float len = length(N);
  return len > 0.0 ? N / len : vec3(0.0);
}

vec3 shading(vec3 N, vec3 V, vec3 L, vec3 Kd)
{
  vec3 H = normalize(L + V);
  float diffuseLight = max(dot(L, N), 0.0);
  float specularLight = pow(max(dot(H, N), 0.0), 20.0);
  return 0.85 * Kd * diffuseLight + vec3(0.3) * specularLight;
}

void main()
{
  vec3 geomPos = gl_TexCoord[0].xyz;
  vec3 camera = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
  vec3 geomDir = normalize(geomPos - camera);
  vec3 position = geomPos;
  vec4 dst = vec4(0.0);

  for (int i = 0; i < 160; i++)
  {
    float value = texture3D(volumeTexture, position).x;
    vec4 src = texture1D(transferFunction, value);

    vec3 N = computeNormal(position);
    src.rgb = shading(N, -geomDir, -geomDir, src.rgb);

    src.rgb *= src.a;
    dst = (1.0 - dst.a) * src + dst;

    position += geomDir * stepSize;
    if (any(lessThan(position, vec3(0.0))) || any(greaterThan(position, vec3(1.0))))
      break;
  }
  gl_FragColor = dst;
}
)");
            const Field marble = [](float x, float y, float z) {
              return 0.5F + 0.3F * std::sin(9 * x + 3 * std::sin(5 * y + 2 * z)) +
                     0.15F * std::cos(11 * y - 4 * z + 1);
            };
            std::vector<Colour> veins;
            for (int i = 0; i < 256; ++i) {
              const int bright = i < 128 ? 0 : i - 128;
              veins.push_back(
                  {static_cast<std::uint8_t>(235 - bright / 2), static_cast<std::uint8_t>(150 + bright / 2),
                   static_cast<std::uint8_t>(110 + i / 3), static_cast<std::uint8_t>(2 + i * i / 2700)});
            }
            upload_volume(canvas, 0, sampled(48, marble), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, veins);
            return [&canvas, program](int frame) {
              const Camera camera =
                  old_camera(canvas, frame, {.azimuth = 110, .elevation = 28, .distance = 2.5F});
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volumeTexture", 0);
              program.set("transferFunction", 1);
              program.set("stepSize", 1.0F / 64);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              canvas.gl.Begin(GL_TRIANGLES);
              for (const Vector& corner : box_triangles()) {
                canvas.gl.TexCoord3f(corner.x, corner.y, corner.z);
                canvas.gl.Vertex3f(corner.x, corner.y, corner.z);
              }
              canvas.gl.End();
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
