// SPDX-License-Identifier: Apache-2.0
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

Scenario wave_lantern_loses_a_third() {
  return {
      .sentence =
          "A cave of 40 x 40 x 40 bytes in GLSL 3.30, lit by a lantern at the eye whose light, diffuse and "
          "specular, loses about a third from the front of the box to its back (1 / (1 + 0.06 d + 0.1 d^2)); "
          "the eye is a flat vec3, rays end at 0.9, the table is edited at frame 13.",
      .expectation = Expectation::either,
      .key_frames = {13},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout (location = 0) in vec3 aPos;

uniform mat4 MVP;
uniform vec3 viewPos;

out vec3 RayDir;
flat out vec3 RayOrigin;

void main()
{
    RayOrigin = viewPos;
    RayDir = aPos - viewPos;
    gl_Position = MVP * vec4(aPos, 1.0);
}
)",
                                  R"(#version 330 core
out vec4 FragColor;

in vec3 RayDir;
flat in vec3 RayOrigin;

struct PointLight {
    float constant;
    float linear;
    float quadratic;
    vec3 ambient;
    vec3 diffuse;
    vec3 specular;
};

uniform sampler3D volume;
uniform sampler2D transfer;
uniform float stepSize;

const PointLight lantern = PointLight(1.0, 0.06, 0.1, vec3(0.2), vec3(1.15), vec3(0.4));

vec3 CalcNormal(vec3 p)
{
    vec3 h = 1.0 / vec3(textureSize(volume, 0));
    vec3 n = vec3(texture(volume, p - vec3(h.x, 0, 0)).r - texture(volume, p + vec3(h.x, 0, 0)).r,
                  texture(volume, p - vec3(0, h.y, 0)).r - texture(volume, p + vec3(0, h.y, 0)).r,
                  texture(volume, p - vec3(0, 0, h.z)).r - texture(volume, p + vec3(0, 0, h.z)).r);
    return n / max(length(n), 1e-4);
}

vec3 CalcPointLight(PointLight light, vec3 albedo, vec3 normal, vec3 fragPos, vec3 viewDir)
{
    vec3 lightDir = normalize(RayOrigin - fragPos);
    float diff = max(dot(normal, lightDir), 0.0);
    vec3 reflectDir = reflect(-lightDir, normal);
    float spec = pow(max(dot(viewDir, reflectDir), 0.0), 8.0);
    float d = length(RayOrigin - fragPos);
    float attenuation = 1.0 / (light.constant + light.linear * d + light.quadratic * d * d);
    return albedo * light.ambient + attenuation * (albedo * light.diffuse * diff + light.specular * spec);
}

void main()
{
    vec3 dir = normalize(RayDir);
    vec3 invDir = 1.0 / dir;
    vec3 tA = -RayOrigin * invDir;
    vec3 tB = (1.0 - RayOrigin) * invDir;
    vec3 tLow = min(tA, tB);
    vec3 tHigh = max(tA, tB);
    float tNear = max(max(tLow.x, tLow.y), max(tLow.z, 0.0));
    float tFar = min(tHigh.x, min(tHigh.y, tHigh.z));

    vec4 acc = vec4(0.0);
    for (float t = tNear; t < tFar; t += stepSize)
    {
        vec3 p = RayOrigin + dir * t;
        vec4 c = texture(transfer, vec2(texture(volume, p).r, 0.5));
        c.rgb = CalcPointLight(lantern, c.rgb, CalcNormal(p), p, -dir);
        acc.rgb += (1.0 - acc.a) * c.rgb * c.a;
        acc.a += (1.0 - acc.a) * c.a;
        if (acc.a > 0.9) break;
    }
    FragColor = acc;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cave = [](float x, float y, float z) {
          return 0.5F + 0.2F * std::sin(9 * x + 3 * std::cos(6 * y)) * std::cos(7 * z) +
                 0.18F * std::sin(8 * y - 5 * z + 2) + 0.1F * std::cos(13 * x + 11 * z);
        };
        upload_volume(canvas, 0, sampled(40, cave));
        auto wet = soft_colours();
        for (std::size_t i = 0; i < wet.size(); ++i)
          wet[i][3] = static_cast<std::uint8_t>(8 + (i > 150 ? (i - 150) / 2 : 0));
        upload_table_2d(canvas, 1, wet);
        program.use();
        program.set("volume", 0);
        program.set("transfer", 1);
        program.set("stepSize", 0.02F);
        return [&canvas, program, vertices](int frame) {
          if (frame == 13) {
            auto dry = other_colours();
            for (std::size_t i = 0; i < dry.size(); ++i)
              dry[i][3] = static_cast<std::uint8_t>(4 + (i < 110 ? (110 - i) / 2 : 0));
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, static_cast<GLsizei>(dry.size()), 1, GL_RGBA,
                                    GL_UNSIGNED_BYTE, dry.data());
          }
          const Orbit orbit{.azimuth = 245, .elevation = 12, .distance = 2.2F, .degrees_each_frame = 1.4F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.03F, 0.03F, 0.03F);
          program.use();
          program.set("MVP", camera.clip_from_object());
          program.set("viewPos", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
