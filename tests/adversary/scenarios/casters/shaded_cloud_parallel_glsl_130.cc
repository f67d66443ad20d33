// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shaded_cloud_parallel_glsl_130() {
  return {
      .sentence =
          "A lumpy ball of 40 x 40 x 40 intensities of 16 bits in parallel projection, GLSL 1.30: "
          "neighbours by textureLodOffset(), Blinn's light on one side, nothing ambient, a 1-D table of "
          "128 bytes, divided by its opacity at last.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 130
out vec3 front;
flat out vec3 rayDir;
void main()
{
    front = gl_Vertex.xyz;
    rayDir = normalize((gl_ModelViewMatrixInverse * vec4(0.0, 0.0, -1.0, 0.0)).xyz);
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)",
                                  R"(#version 130
uniform sampler3D vol;
uniform sampler1D lut;
uniform float stepLen;
uniform vec2 light;   // diffuse, specular
in vec3 front;
flat in vec3 rayDir;
out vec4 color;

vec3 normalAt(vec3 tc)
{
    vec3 hi = vec3(textureLodOffset(vol, tc, 0.0, ivec3(1, 0, 0)).r,
                   textureLodOffset(vol, tc, 0.0, ivec3(0, 1, 0)).r,
                   textureLodOffset(vol, tc, 0.0, ivec3(0, 0, 1)).r);
    vec3 lo = vec3(textureLodOffset(vol, tc, 0.0, ivec3(-1, 0, 0)).r,
                   textureLodOffset(vol, tc, 0.0, ivec3(0, -1, 0)).r,
                   textureLodOffset(vol, tc, 0.0, ivec3(0, 0, -1)).r);
    vec3 n = lo - hi;
    return n / (length(n) + 1e-9);
}

void main()
{
    vec3 inv = 1.0 / (rayDir + vec3(1e-7));
    vec3 far3 = max((vec3(0.0) - front) * inv, (vec3(1.0) - front) * inv);
    float tEnd = min(far3.x, min(far3.y, far3.z));
    vec3 view = -rayDir;
    vec3 halfway = normalize(view + view);

    color = vec4(0.0);
    float t = 0.0;
    while (t <= tEnd)
    {
        vec3 tc = front + t * rayDir;
        vec4 src = textureLod(lut, textureLod(vol, tc, 0.0).r, 0.0);
        vec3 n = normalAt(tc);
        float lambert = max(dot(n, view), 0.0);
        float gloss = pow(max(dot(n, halfway), 0.0), 20.0);
        src.rgb = src.rgb * light.x * lambert + light.y * gloss;
        src.rgb *= src.a;
        color = color + src * (1.0 - color.a);
        t += stepLen;
    }
    if (color.a > 0.0)
        color.rgb /= color.a;
}
)");
        const Field lumps = [](float x, float y, float z) {
          const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
          const float noise = std::sin(15 * x + 3 * std::sin(9 * y)) + std::sin(14 * y + 2 * std::sin(11 * z)) +
                              std::sin(16 * z + 2 * std::sin(10 * x));
          return std::clamp(1.05F - 1.7F * std::sqrt(u * u + v * v + w * w) + 0.05F * noise, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 128; ++i) {
          const float at = static_cast<float>(i) / 127;
          const float shell = std::exp(-std::pow((at - 0.3F) / 0.06F, 2.0F));
          const float inner = std::clamp((at - 0.5F) / 0.2F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(255 - 120 * inner),
                           static_cast<std::uint8_t>(200 - 60 * at),
                           static_cast<std::uint8_t>(110 + 140 * inner),
                           static_cast<std::uint8_t>(std::lround(20 * shell + 110 * inner))});
        }
        upload_volume(canvas, 0, sampled(40, lumps), {.texel = Texel::unsigned16, .shown = Shown::intensity});
        upload_table_1d(canvas, 1, table);
        return [&canvas, program, corners = box_triangles()](int frame) {
          begin_old_frame(canvas, old_camera(canvas, frame,
                                             {.azimuth = 310,
                                              .elevation = 17,
                                              .degrees_each_frame = 2,
                                              .projection = Projection::parallel}));
          program.use();
          program.set("vol", 0);
          program.set("lut", 1);
          program.set("stepLen", 0.018F);
          canvas.gl.Uniform2f(program.location("light"), 1, 0.35F);
          set_blending(canvas.gl, Blending::over);
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
