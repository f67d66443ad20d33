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

Scenario warm_highlight() {
  return {
      .sentence =
          "A shell of 44 x 36 x 48 numbers of 16 bits in GLSL 3.30: Blinn's and Phong's light from "
          "the eye, ambient and diffuse white, the highlight of a warm colour; normals over one "
          "texel, normalised where they are not zero.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core

layout(location = 0) in vec3 in_Position;

uniform mat4 ModelViewProjectionMatrix;

smooth out vec3 TexCoord;

void main()
{
    TexCoord = in_Position;
    gl_Position = ModelViewProjectionMatrix * vec4(in_Position, 1.0);
}
)",
                                  R"(#version 330 core

smooth in vec3 TexCoord;
layout(location = 0) out vec4 out_Color;

uniform sampler3D Volume;
uniform sampler1D TransferFunction;
uniform vec3 CameraPosition;
uniform float StepSize;

const vec3 ka = vec3(0.3);
const vec3 kd = vec3(0.7);
const vec3 ks = vec3(0.35, 0.3, 0.18);
const float shininess = 24.0;

float sampleVolume(vec3 p)
{
    return texture(Volume, p).r;
}

vec3 centralDifferences(vec3 p)
{
    vec3 h = 1.0 / vec3(textureSize(Volume, 0));
    return vec3(
        sampleVolume(p + vec3(h.x, 0.0, 0.0)) - sampleVolume(p - vec3(h.x, 0.0, 0.0)),
        sampleVolume(p + vec3(0.0, h.y, 0.0)) - sampleVolume(p - vec3(0.0, h.y, 0.0)),
        sampleVolume(p + vec3(0.0, 0.0, h.z)) - sampleVolume(p - vec3(0.0, 0.0, h.z))) / (2.0 * h);
}

vec3 blinnPhong(vec3 color, vec3 n, vec3 l, vec3 v)
{
    vec3 h = normalize(l + v);
    float diffuse = max(dot(n, l), 0.0);
    float specular = pow(max(dot(n, h), 0.0), shininess);
    return color * (ka + kd * diffuse) + ks * specular;
}

void main()
{
    vec3 direction = normalize(TexCoord - CameraPosition);
    vec3 t1 = (vec3(0.0) - CameraPosition) / direction;
    vec3 t2 = (vec3(1.0) - CameraPosition) / direction;
    vec3 tNear3 = min(t1, t2);
    vec3 tFar3 = max(t1, t2);
    float begin = max(max(max(tNear3.x, tNear3.y), tNear3.z), 0.0);
    float end = min(min(tFar3.x, tFar3.y), tFar3.z);

    vec4 result = vec4(0.0);
    for (float t = begin; t < end; t += StepSize)
    {
        vec3 p = CameraPosition + t * direction;
        vec4 c = texture(TransferFunction, sampleVolume(p));
        vec3 n = -centralDifferences(p);
        if (dot(n, n) > 0.0)
            n = normalize(n);
        vec3 v = normalize(CameraPosition - p);
        vec3 lit = blinnPhong(c.rgb, n, v, v);
        result.rgb += (1.0 - result.a) * c.a * lit;
        result.a += (1.0 - result.a) * c.a;
    }
    out_Color = result;
}
)");
        const VertexBuffer vertices(canvas);
        const Field shell = [](float x, float y, float z) {
          const float a = x - 0.47F, b = y - 0.52F, c = z - 0.55F;
          const float turn = std::atan2(b, a);
          const float away = std::sqrt(a * a + b * b + 1.2F * c * c);
          return std::clamp(0.95F - 1.5F * away + 0.07F * std::sin(3 * turn + 12 * c), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float ridge = std::exp(-std::pow((at - 0.45F) / 0.12F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(90 + 90 * at), static_cast<std::uint8_t>(110 + 60 * ridge),
                           static_cast<std::uint8_t>(200 - 90 * at),
                           static_cast<std::uint8_t>(std::lround(44 * ridge + 14 * at))});
        }
        upload_volume(canvas, 0, sampled(44, 36, 48, shell), {.texel = Texel::unsigned16});
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("Volume", 0);
        program.set("TransferFunction", 1);
        program.set("StepSize", 0.018F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 145, .elevation = 28, .distance = 2.4F, .degrees_each_frame = 1.4F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.1F, 0.12F, 0.16F);
          program.use();
          program.set("ModelViewProjectionMatrix", camera.clip_from_object());
          program.set("CameraPosition", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
