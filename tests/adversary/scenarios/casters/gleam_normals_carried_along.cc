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

Scenario gleam_normals_carried_along() {
  return {.sentence =
              "A coil of 44 x 44 x 44 texels of 16 bits in GLSL 4.10, lit from the eye on both sides; against "
              "noise, each sample's normal is mixed with those of the samples before it on the ray.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 Mvp;
out vec3 EntryPoint;
void main()
{
  EntryPoint = position;
  gl_Position = Mvp * vec4(position, 1.0);
}
)",
                                      R"(#version 410 core
in vec3 EntryPoint;
layout(location = 0) out vec4 FragColor;
uniform sampler3D VolumeTex;
uniform sampler1D TransferFunc;
uniform vec3 EyePosition;
uniform float StepSize;
uniform float Delta;
uniform float Smoothing;

vec3 Gradient(vec3 p)
{
  vec2 d = vec2(Delta, 0.0);
  return vec3(texture(VolumeTex, p + d.xyy).r - texture(VolumeTex, p - d.xyy).r,
              texture(VolumeTex, p + d.yxy).r - texture(VolumeTex, p - d.yxy).r,
              texture(VolumeTex, p + d.yyx).r - texture(VolumeTex, p - d.yyx).r);
}

void main()
{
  vec3 dir = normalize(EntryPoint - EyePosition);
  vec3 toExit = (step(vec3(0.0), dir) - EntryPoint) / dir;
  int samples = int(min(toExit.x, min(toExit.y, toExit.z)) / StepSize) + 1;

  vec3 smoothNormal = vec3(0.0);
  vec4 dst = vec4(0.0);
  for (int i = 0; i < samples; ++i)
  {
    vec3 p = EntryPoint + float(i) * StepSize * dir;
    vec4 src = texture(TransferFunc, texture(VolumeTex, p).r);

    vec3 g = Gradient(p);
    vec3 normal = g / max(length(g), 1e-5);
    smoothNormal = i == 0 ? normal : mix(normal, smoothNormal, Smoothing);
    float cosine = abs(dot(smoothNormal, dir)) / max(length(smoothNormal), 1e-5);

    src.rgb = src.rgb * (0.2 + 0.7 * cosine) + 0.2 * pow(min(cosine, 1.0), 24.0);
    src.rgb *= src.a;
    dst += (1.0 - dst.a) * src;
    if (dst.a > 0.99)
      break;
  }
  FragColor = dst;
}
)");
            const VertexBuffer vertices(canvas);
            const Field coil = [](float x, float y, float z) {
              const float r = std::hypot(x - 0.5F, z - 0.5F);
              const float turn = std::cos(16 * y) * (x - 0.5F) + std::sin(16 * y) * (z - 0.5F);
              return 0.5F + 0.3F * std::cos(13 * r) * std::sin(7 * turn + 1) + 0.15F * std::sin(8 * y + 5 * x);
            };
            std::vector<Colour> colours;
            colours.reserve(256);
            for (int i = 0; i < 256; ++i)
              colours.push_back({static_cast<std::uint8_t>(240 - i / 3), static_cast<std::uint8_t>(100 + i / 2),
                                 static_cast<std::uint8_t>(60 + i * i / 500),
                                 static_cast<std::uint8_t>(5 + i * i / 2000)});
            upload_volume(canvas, 0, sampled(44, coil), {.texel = Texel::unsigned16});
            upload_table_1d(canvas, 1, colours);
            program.use();
            program.set("VolumeTex", 0);
            program.set("TransferFunc", 1);
            program.set("StepSize", 0.02F);
            program.set("Delta", 1.0F / 44);
            program.set("Smoothing", 0.6F);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 80, .elevation = 18, .distance = 2.5F, .degrees_each_frame = 1.3F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.2F, 0.16F, 0.14F);
              program.use();
              program.set("Mvp", camera.clip_from_object());
              program.set("EyePosition", camera.eye);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
