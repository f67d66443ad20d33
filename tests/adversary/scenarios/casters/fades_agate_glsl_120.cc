// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_agate_glsl_120() {
  return {.sentence =
              "Agate of 48 x 48 x 48 luminance bytes in GLSL 1.20, immediate mode, not lit: opacity by the "
              "alpha of a second 1-D table, looked up by the length of differences at a constant distance; "
              "rays end at 0.98.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D stone;
uniform sampler1D colourTable;
uniform sampler1D edgeTable;
uniform float stepSize;

const float DELTA = 1.0 / 48.0;
const float EDGE_SCALE = 5.0;

float edge(vec3 p)
{
  vec3 s1, s2;
  s1.x = texture3D(stone, p - vec3(DELTA, 0.0, 0.0)).x;
  s2.x = texture3D(stone, p + vec3(DELTA, 0.0, 0.0)).x;
  s1.y = texture3D(stone, p - vec3(0.0, DELTA, 0.0)).x;
  s2.y = texture3D(stone, p + vec3(0.0, DELTA, 0.0)).x;
  s1.z = texture3D(stone, p - vec3(0.0, 0.0, DELTA)).x;
  s2.z = texture3D(stone, p + vec3(0.0, 0.0, DELTA)).x;
  return texture1D(edgeTable, EDGE_SCALE * length(s2 - s1)).a;
}

void main()
{
  vec3 position = gl_TexCoord[0].xyz;
  vec3 camera = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
  vec3 direction = normalize(position - camera);
  vec4 dst = vec4(0.0);

  for (int i = 0; i < 160; i++)
  {
    vec4 src = texture1D(colourTable, texture3D(stone, position).x);
    src.a *= edge(position);
    src.rgb *= src.a;
    dst = (1.0 - dst.a) * src + dst;
    if (dst.a > 0.98)
      break;

    position += direction * stepSize;
    if (any(lessThan(position, vec3(0.0))) || any(greaterThan(position, vec3(1.0))))
      break;
  }
  gl_FragColor = dst;
}
)");
            const Field agate = [](float x, float y, float z) {
              return 0.5F + 0.3F * std::sin(8 * x + 3 * std::sin(4 * y + 2 * z)) +
                     0.15F * std::cos(10 * y - 5 * z + 1);
            };
            std::vector<Colour> colours, edges;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float band = 0.5F + 0.5F * std::sin(11 * at);
              colours.push_back({static_cast<std::uint8_t>(240 - 120 * at),
                                 static_cast<std::uint8_t>(90 + 110 * band),
                                 static_cast<std::uint8_t>(60 + 180 * at),
                                 static_cast<std::uint8_t>(std::lround(10 + 26 * band))});
              const float rise = std::clamp((at - 0.2F) / 0.4F, 0.0F, 1.0F);
              const float fall = 1 - 0.8F * std::clamp((at - 0.75F) / 0.25F, 0.0F, 1.0F);
              edges.push_back({255, 255, 255, static_cast<std::uint8_t>(std::lround(255 * rise * fall))});
            }
            upload_volume(canvas, 0, sampled(48, agate), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, colours);
            upload_table_1d(canvas, 2, edges);
            return [&canvas, program](int frame) {
              const Camera camera =
                  old_camera(canvas, frame, {.azimuth = 165, .elevation = 22, .distance = 2.5F});
              begin_old_frame(canvas, camera);
              program.use();
              program.set("stone", 0);
              program.set("colourTable", 1);
              program.set("edgeTable", 2);
              program.set("stepSize", 1.0F / 60);
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
