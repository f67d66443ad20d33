// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_by_texture_offset() {
  return {.sentence =
              "Marschner and Lobb's signal in 72 x 72 x 72 texels of 16 bits, GLSL 4.00, neighbours by "
              "textureOffset(), colours by formula, Lambert on one side only and nothing ambient, so that "
              "what turns away is black.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 vertPosition;
uniform mat4 MVP;
out vec3 EntryPoint;
void main() {
  EntryPoint = vertPosition;
  gl_Position = MVP * vec4(vertPosition, 1.0);
}
)",
                                      R"(#version 400 core
in vec3 EntryPoint;
uniform sampler3D VolumeTex;
uniform vec3 CameraPos;
uniform float StepSize;
uniform float IsoLevel;
layout(location = 0) out vec4 FragColor;

vec3 estimateNormal(vec3 p) {
  vec3 n = vec3(textureOffset(VolumeTex, p, ivec3(-1, 0, 0)).x - textureOffset(VolumeTex, p, ivec3(1, 0, 0)).x,
                textureOffset(VolumeTex, p, ivec3(0, -1, 0)).x - textureOffset(VolumeTex, p, ivec3(0, 1, 0)).x,
                textureOffset(VolumeTex, p, ivec3(0, 0, -1)).x - textureOffset(VolumeTex, p, ivec3(0, 0, 1)).x);
  float magnitude = length(n);
  return magnitude > 1e-7 ? n / magnitude : vec3(0.0);
}

vec4 classify(float intensity) {
  float d = (intensity - IsoLevel) / 0.07;
  float opacity = 0.3 * exp(-d * d) + 0.04 * smoothstep(0.55, 0.9, intensity);
  vec3 albedo = mix(vec3(0.15, 0.55, 0.95), vec3(1.0, 0.85, 0.45), smoothstep(0.35, 0.7, intensity));
  return vec4(albedo, opacity);
}

void main() {
  vec3 dir = normalize(EntryPoint - CameraPos);
  vec3 deltaDir = dir * StepSize;
  vec3 voxelCoord = EntryPoint;
  vec4 colorAcum = vec4(0.0);

  for (int i = 0; i < 200; i++) {
    float intensity = texture(VolumeTex, voxelCoord).x;
    vec4 colorSample = classify(intensity);
    colorSample.rgb *= max(dot(estimateNormal(voxelCoord), -dir), 0.0);
    colorAcum.rgb += (1.0 - colorAcum.a) * colorSample.rgb * colorSample.a;
    colorAcum.a += (1.0 - colorAcum.a) * colorSample.a;

    voxelCoord += deltaDir;
    if (voxelCoord.x < 0.0 || voxelCoord.y < 0.0 || voxelCoord.z < 0.0 ||
        voxelCoord.x > 1.0 || voxelCoord.y > 1.0 || voxelCoord.z > 1.0)
      break;
  }
  FragColor = colorAcum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field signal = [](float x, float y, float z) {
              constexpr float pi = std::numbers::pi_v<float>;
              const float u = 2 * x - 1, v = 2 * z - 1, w = 2 * y - 1;
              const float radial = std::cos(2 * pi * 5 * std::cos(pi * std::sqrt(u * u + v * v) / 2));
              return (1 - std::sin(pi * w / 2) + 0.25F * (1 + radial)) / 2.5F;
            };
            upload_volume(canvas, 0, sampled(72, signal), {.texel = Texel::unsigned16});
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 10, .elevation = 38, .distance = 2.75F, .degrees_each_frame = -1};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.3F, 0.3F, 0.3F);
              program.use();
              program.set("MVP", camera.clip_from_object());
              program.set("CameraPos", camera.eye);
              program.set("VolumeTex", 0);
              program.set("StepSize", 0.0125F);
              program.set("IsoLevel", 0.47F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
