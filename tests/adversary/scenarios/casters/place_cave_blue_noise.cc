// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
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

Scenario place_cave_blue_noise() {
  return {
      .sentence =
          "A cave of 48 x 40 x 56 half floats in GLSL 4.20; every ray begins within its first step where a "
          "texture "
          "of 16 x 16 texels tells, fetched by gl_FragCoord & 15. From frame 15 on jitter is off: half a step "
          "in.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 vertexPos;
uniform mat4 uModelViewProj;
out vec3 vPos;
void main() {
  vPos = vertexPos;
  gl_Position = uModelViewProj * vec4(vertexPos, 1.0);
}
)",
                                  R"(#version 420 core
layout(binding = 0) uniform sampler3D uVolume;
layout(binding = 1) uniform sampler1D uTransfer;
layout(binding = 2) uniform sampler2D uBlueNoise;

uniform vec3 uCamPos;
uniform float uStep;
uniform float uJitter;

in vec3 vPos;
layout(location = 0) out vec4 fragColor;

vec2 intersectAABB(vec3 ro, vec3 rd) {
  vec3 inv = 1.0 / rd;
  vec3 t0 = -ro * inv;
  vec3 t1 = (vec3(1.0) - ro) * inv;
  vec3 tn = min(t0, t1), tf = max(t0, t1);
  return vec2(max(tn.x, max(tn.y, tn.z)), min(tf.x, min(tf.y, tf.z)));
}

void main() {
  vec3 rd = normalize(vPos - uCamPos);
  vec2 hit = intersectAABB(uCamPos, rd);
  float offset = mix(0.5, texelFetch(uBlueNoise, ivec2(gl_FragCoord.xy) & 15, 0).r, uJitter);
  vec4 acc = vec4(0.0);
  for (float t = hit.x + uStep * offset; t < hit.y; t += uStep) {
    float density = texture(uVolume, uCamPos + rd * t).r;
    vec4 c = texture(uTransfer, density);
    c.rgb *= c.a;
    acc += (1.0 - acc.a) * c;
    if (acc.a > 0.98) break;
  }
  fragColor = acc;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cave = [](float x, float y, float z) {
          const float dx = x - 0.5F - 0.15F * std::sin(5 * z), dy = y - 0.45F - 0.1F * std::cos(6 * z);
          const float tunnel = std::sqrt(dx * dx + dy * dy);
          const float drops =
              0.15F * std::sin(16 * x + 3 * y) * std::sin(13 * y - 4 * z) + 0.1F * std::sin(21 * z + 8 * x);
          return std::clamp(1.6F * tunnel + drops, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float wall = std::exp(-std::pow((at - 0.45F) / 0.12F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(70 + 160 * wall), static_cast<std::uint8_t>(90 + 90 * at),
                           static_cast<std::uint8_t>(200 - 150 * wall * at),
                           static_cast<std::uint8_t>(std::lround(4 + 90 * wall + 14 * at))});
        }
        upload_volume(canvas, 0, sampled(48, 40, 56, cave), {.texel = Texel::half});
        upload_table_1d(canvas, 1, table);
        std::vector<std::uint8_t> noise;
        for (int i = 0; i < 256; ++i)
          noise.push_back(static_cast<std::uint8_t>((i * 97 + (i / 16) * 41) & 255));
        upload_mask_2d(canvas, 2, noise, 16);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 20, .elevation = 24, .degrees_each_frame = 3}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.05F, 0.06F, 0.1F);
          program.use();
          program.set("uModelViewProj", camera.clip_from_object());
          program.set("uCamPos", camera.eye);
          program.set("uStep", 0.035F);
          program.set("uJitter", frame < 15 ? 1.0F : 0.0F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
