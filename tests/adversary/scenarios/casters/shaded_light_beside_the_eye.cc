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

Scenario shaded_light_beside_the_eye() {
  return {
      .sentence =
          "A torus of 48 x 48 x 48 bytes, Lambert's light with ambient, GLSL 3.30, from a miner's light that "
          "goes along with the camera, but a few degrees to its right and above.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 aPos;
uniform mat4 uMVP;
out vec3 vTexCoord;
void main()
{
    vTexCoord = aPos;
    gl_Position = uMVP * vec4(aPos, 1.0);
}
)",
                                  R"(#version 330 core
in vec3 vTexCoord;
out vec4 FragColor;
uniform sampler3D uVolume;
uniform sampler1D uTransfer;
uniform vec3 uViewPos;
uniform vec3 uLightPos;
uniform float uStep;
uniform float uDelta;

vec3 getNormal(vec3 p)
{
    float dx = texture(uVolume, p - vec3(uDelta, 0, 0)).r - texture(uVolume, p + vec3(uDelta, 0, 0)).r;
    float dy = texture(uVolume, p - vec3(0, uDelta, 0)).r - texture(uVolume, p + vec3(0, uDelta, 0)).r;
    float dz = texture(uVolume, p - vec3(0, 0, uDelta)).r - texture(uVolume, p + vec3(0, 0, uDelta)).r;
    vec3 n = vec3(dx, dy, dz);
    return n / max(length(n), 1e-6);
}

void main()
{
    vec3 rd = normalize(vTexCoord - uViewPos);
    vec3 b = max(-vTexCoord / rd, (1.0 - vTexCoord) / rd);
    float tFar = min(b.x, min(b.y, b.z));
    vec4 dst = vec4(0.0);
    for (float t = 0.0; t < tFar; t += uStep)
    {
        vec3 p = vTexCoord + rd * t;
        vec4 src = texture(uTransfer, texture(uVolume, p).r);
        vec3 lightDir = normalize(uLightPos - p);
        float diff = max(dot(getNormal(p), lightDir), 0.0);
        src.rgb *= 0.2 + 0.8 * diff;
        src.rgb *= src.a;
        dst = (1.0 - dst.a) * src + dst;
        if (dst.a > 0.98) break;
    }
    FragColor = dst;
}
)");
        const VertexBuffer vertices(canvas);
        const Field torus = [](float x, float y, float z) {
          float nearest = 9;
          for (int i = 0; i < 96; ++i) {
            const float turn = 6.2832F * static_cast<float>(i) / 96;
            const float radius = 0.24F + 0.09F * std::cos(3 * turn);
            const float u = x - 0.5F - radius * std::cos(2 * turn);
            const float v = y - 0.5F - radius * std::sin(2 * turn);
            const float w = z - 0.5F - 0.12F * std::sin(3 * turn);
            nearest = std::min(nearest, u * u + v * v + w * w);
          }
          return std::clamp(1 - std::sqrt(nearest) / 0.16F, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float solid = std::clamp((at - 0.4F) / 0.15F, 0.0F, 1.0F);
          const float haze = at > 0.1F ? std::exp(-std::pow((at - 0.22F) / 0.07F, 2.0F)) : 0;
          table.push_back({static_cast<std::uint8_t>(90 + 150 * at), static_cast<std::uint8_t>(210 - 60 * at),
                           static_cast<std::uint8_t>(120 + 60 * solid),
                           static_cast<std::uint8_t>(std::lround(14 * haze + 90 * solid))});
        }
        upload_volume(canvas, 0, sampled(48, torus));
        upload_table_1d(canvas, 1, table);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 15, .elevation = 22, .distance = 2.2F, .degrees_each_frame = 1.5F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector right = normalized(cross(camera.forward, {0, 1, 0}));
          const Vector up = cross(right, camera.forward);
          canvas.begin(0.1F, 0.1F, 0.1F);
          program.use();
          program.set("uMVP", camera.clip_from_object());
          program.set("uViewPos", camera.eye);
          program.set("uLightPos", camera.eye + 0.16F * right + 0.12F * up);
          program.set("uVolume", 0);
          program.set("uTransfer", 1);
          program.set("uStep", 0.015F);
          program.set("uDelta", 1 / 48.0F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
