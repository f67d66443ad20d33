// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_brightness_glsl_120() {
  return {.sentence =
              "Lichen of 44 x 36 x 40 luminance bytes in GLSL 1.20, immediate mode: the composed colour, "
              "without its alpha, is multiplied by a brightness after the loop, 1 until frame 9, 0.35 from "
              "frame 10 on, and 1.6 from frame 20 on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D vol;
uniform sampler1D lut;
uniform float delta;
uniform float brightness;

void main()
{
  vec4 eye = gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0);
  vec3 p = gl_TexCoord[0].xyz;
  vec3 d = delta * normalize(p - eye.xyz);
  vec4 result = vec4(0.0);
  for (int i = 0; i < 180; i++)
  {
    vec4 entry = texture1D(lut, texture3D(vol, p).r);
    entry.rgb *= entry.a;
    result += (1.0 - result.a) * entry;
    p += d;
    if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0))))
      break;
  }
  result.rgb *= brightness;
  gl_FragColor = result;
}
)");
            const Field lichen = [](float x, float y, float z) {
              const float folds = std::sin(10 * x + 3 * std::sin(6 * z)) + std::cos(11 * z - 4 * y) +
                                  0.7F * std::sin(17 * x * z + 6 * y);
              return std::clamp(0.62F + 0.22F * folds - 0.5F * y, 0.0F, 1.0F);
            };
            std::vector<Colour> lut;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              lut.push_back({static_cast<std::uint8_t>(90 + 110 * at),
                             static_cast<std::uint8_t>(190 - 60 * std::sin(8 * at)),
                             static_cast<std::uint8_t>(60 + 120 * at * at),
                             static_cast<std::uint8_t>(std::lround(3 + 45 * at * at * at))});
            }
            upload_volume(canvas, 0, sampled(44, 36, 40, lichen), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, lut);
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(
                  canvas, frame, {.azimuth = 320, .elevation = 31, .distance = 2.4F, .degrees_each_frame = 2});
              begin_old_frame(canvas, camera);
              program.use();
              program.set("vol", 0);
              program.set("lut", 1);
              program.set("delta", 1.0F / 60);
              program.set("brightness", frame < 10 ? 1.0F : frame < 20 ? 0.35F : 1.6F);
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
