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

Scenario count_ceil_middles() {
  return {
      .sentence =
          "A bubble bath of 40 x 48 x 32 bytes in GLSL 3.30: as many samples as the ray's length "
          "divided by the step, rounded up, each in the middle of its step; the last may lie behind "
          "the exit.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout (location = 0) in vec3 aPos;

uniform mat4 uProjection;
uniform mat4 uView;

out vec3 vPos;

void main()
{
    vPos = aPos;
    gl_Position = uProjection * uView * vec4(aPos, 1.0);
}
)",
                                  R"(#version 330 core
in vec3 vPos;
out vec4 FragColor;

uniform sampler3D uVolume;
uniform sampler2D uTransfer;
uniform vec3 uCamPos;
uniform float uStepSize;

vec2 intersectBox(vec3 ro, vec3 rd)
{
    vec3 invDir = 1.0 / rd;
    vec3 t0 = (vec3(0.0) - ro) * invDir;
    vec3 t1 = (vec3(1.0) - ro) * invDir;
    vec3 tmin = min(t0, t1);
    vec3 tmax = max(t0, t1);
    return vec2(max(max(tmin.x, tmin.y), tmin.z), min(min(tmax.x, tmax.y), tmax.z));
}

void main()
{
    vec3 rd = normalize(vPos - uCamPos);
    vec2 hit = intersectBox(uCamPos, rd);
    hit.x = max(hit.x, 0.0);
    float len = hit.y - hit.x;
    if (len <= 0.0)
        discard;

    int n = int(ceil(len / uStepSize));
    vec3 delta = rd * uStepSize;
    vec3 pos = uCamPos + rd * hit.x + 0.5 * delta;

    vec4 dst = vec4(0.0);
    for (int i = 0; i < n; ++i)
    {
        float density = texture(uVolume, pos).r;
        vec4 src = texture(uTransfer, vec2(density, 0.5));
        src.rgb *= src.a;
        dst += (1.0 - dst.a) * src;
        pos += delta;
    }
    FragColor = dst;
}
)");
        const VertexBuffer vertices(canvas);
        const Field bath = [](float x, float y, float z) {
          const float a = x - 0.35F, b = y - 0.6F, c = z - 0.45F;
          const float d = x - 0.7F, e = y - 0.3F, f = z - 0.62F;
          return std::clamp(0.75F * std::exp(-14 * (a * a + b * b + c * c)) +
                                0.65F * std::exp(-22 * (d * d + e * e + 0.7F * f * f)) +
                                0.06F * std::sin(13 * x + 8 * y) * std::cos(10 * z) + 0.1F,
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float skin = std::exp(-std::pow((at - 0.4F) / 0.13F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(70 + 170 * at), static_cast<std::uint8_t>(200 - 120 * at),
                           static_cast<std::uint8_t>(230 - 200 * at * at),
                           static_cast<std::uint8_t>(std::lround(3 + 26 * skin + 22 * at * at))});
        }
        upload_volume(canvas, 0, sampled(40, 48, 32, bath));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("uVolume", 0);
        program.set("uTransfer", 1);
        program.set("uStepSize", 0.023F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 62, .elevation = 24, .distance = 2.5F, .degrees_each_frame = 1};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.05F, 0.08F, 0.12F);
          program.use();
          program.set("uProjection", camera.projection);
          program.set("uView", camera.view);
          program.set("uCamPos", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
