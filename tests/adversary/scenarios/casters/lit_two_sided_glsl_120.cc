// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_two_sided_glsl_120() {
  return {.sentence =
              "Lambert's light from the eye on both sides, by abs(), GLSL 1.20: matrices of fixed function, a "
              "luminance texture, a 1-D table, vertex arrays. A gyroid that the box cuts.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 120
varying vec3 entry;
varying vec3 viewer;
void main()
{
    entry = gl_Vertex.xyz;
    viewer = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)",
                                      R"(#version 120
uniform sampler3D volumeTexture;
uniform sampler1D colourTable;
uniform float delta;
uniform float stepSize;
varying vec3 entry;
varying vec3 viewer;

float scalar(vec3 p) { return texture3D(volumeTexture, p).r; }

void main()
{
    vec3 dir = normalize(entry - viewer);
    vec3 dx = vec3(delta, 0.0, 0.0);
    vec3 dy = dx.yxz;
    vec3 dz = dx.yzx;

    vec3 t1 = (vec3(0.0) - entry) / dir;
    vec3 t2 = (vec3(1.0) - entry) / dir;
    vec3 tmax = max(t1, t2);
    float tFar = min(tmax.x, min(tmax.y, tmax.z));

    vec4 accum = vec4(0.0);
    float t = 0.5 * stepSize;
    for (int i = 0; i < 160; i++) {
        if (t > tFar)
            break;
        vec3 p = entry + t * dir;
        vec4 c = texture1D(colourTable, scalar(p));

        vec3 g;
        g.x = scalar(p + dx) - scalar(p - dx);
        g.y = scalar(p + dy) - scalar(p - dy);
        g.z = scalar(p + dz) - scalar(p - dz);
        float len = length(g);
        if (len > 0.0)
            g /= len;

        c.rgb *= 0.35 + 0.65 * abs(dot(g, dir));
        accum.rgb += (1.0 - accum.a) * c.a * c.rgb;
        accum.a += (1.0 - accum.a) * c.a;
        t += stepSize;
    }
    gl_FragColor = accum;
}
)");
            const Field gyroid = [](float x, float y, float z) {
              const float u = 9 * x + 0.7F, v = 8 * y, w = 10 * z + 0.3F;
              const float sheet =
                  std::sin(u) * std::cos(v) + std::sin(v) * std::cos(w) + std::sin(w) * std::cos(u);
              return 0.5F + 0.24F * sheet + 0.06F * (x - y);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float outer = std::exp(-std::pow((at - 0.62F) / 0.06F, 2.0F));
              const float inner = std::exp(-std::pow((at - 0.8F) / 0.07F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(at < 0.7F ? 235 : 90),
                               static_cast<std::uint8_t>(40 + 190 * at),
                               static_cast<std::uint8_t>(at < 0.7F ? 60 : 220),
                               static_cast<std::uint8_t>(std::lround(20 * outer + 70 * inner))});
            }
            upload_volume(canvas, 0, sampled(64, gyroid), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, table);
            return [&canvas, program, corners = box_triangles()](int frame) {
              begin_old_frame(canvas, old_camera(canvas, frame, {.azimuth = 205, .elevation = 28}));
              program.use();
              program.set("volumeTexture", 0);
              program.set("colourTable", 1);
              program.set("delta", 1 / 64.0F);
              program.set("stepSize", 0.02F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              canvas.gl.EnableClientState(GL_VERTEX_ARRAY);
              canvas.gl.VertexPointer(3, GL_FLOAT, sizeof(Vector), corners.data());
              canvas.gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
              canvas.gl.DisableClientState(GL_VERTEX_ARRAY);
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
