// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {
namespace {

constexpr const char* heart_fragment = R"(#version 330 core
uniform sampler3D u_ct;
uniform sampler1D u_lut;
uniform vec3 u_eye;
uniform float u_level;
uniform float u_window;
uniform float u_ds;
in vec3 at;
layout(location = 0) out vec4 fragColor;

float windowed(float raw) {
  float hu = raw * 65535.0 - 1024.0;
  return clamp((hu - u_level) / u_window + 0.5, 0.0, 1.0);
}

void main() {
  vec3 dir = normalize(at - u_eye);
  vec3 inv = 1.0 / dir;
  vec3 t1 = max(-u_eye * inv, (1.0 - u_eye) * inv);
  float tFar = min(t1.x, min(t1.y, t1.z));
  float t = distance(at, u_eye);
  vec4 dst = vec4(0.0);
  while (t < tFar && dst.a < 0.99) {
    vec4 src = texture(u_lut, windowed(texture(u_ct, u_eye + t * dir).r));
    src.rgb *= src.a;
    dst += src * (1.0 - dst.a);
    t += u_ds;
  }
  fragColor = dst;
}
)";

/// Raw numbers of 12 bits: Hounsfield units and 1024.
float chest_at(float x, float y, float z, float beat) {
  const float a = x - 0.55F, b = y - 0.5F, c = z - 0.45F;
  const float heart = std::sqrt(a * a + 1.3F * b * b + c * c) - 0.22F * (1 + 0.5F * beat);
  const float muscle = 1100 / (1 + std::exp(45 * heart));
  const float ribs = 700 * std::exp(-60 * std::pow(std::sin(9 * y + 1.5F * x), 2.0F)) *
                     std::clamp(8 * (a * a + c * c) - 0.7F, 0.0F, 1.0F);
  const float lung = 220 + 120 * std::sin(8 * x + 5 * z) + 80 * std::sin(11 * y + 2 * x);
  return std::clamp(lung + muscle + ribs, 0.0F, 4095.0F) / 65535;
}

}  // namespace

Scenario change_window_of_beating_heart() {
  std::vector<int> every;
  for (int frame = 1; frame < 30; ++frame) every.push_back(frame);
  return {.sentence =
              "A heart of 48 x 40 x 44 texels, 12 bits in 16, GLSL 3.30 and a 1-D table: window and level "
              "change in "
              "every frame, and from frame 10 on a third of the volume comes again by glTexSubImage3D in every "
              "third.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = every,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, caster_vertex_shader, heart_fragment);
            const VertexBuffer vertices(canvas);
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(255 * std::sqrt(at)),
                               static_cast<std::uint8_t>(40 + 190 * at * at),
                               static_cast<std::uint8_t>(60 + 60 * std::sin(6 * at)),
                               static_cast<std::uint8_t>(std::lround(40 * at * at))});
            }
            const VolumeFormat format{.texel = Texel::unsigned16};
            const auto at_beat = [](float beat) {
              return sampled(48, 40, 44, [beat](float x, float y, float z) { return chest_at(x, y, z, beat); });
            };
            const GLuint volume = upload_volume(canvas, 0, at_beat(0), format);
            upload_table_1d(canvas, 1, table);
            program.use();
            program.set("u_ct", 0);
            program.set("u_lut", 1);
            program.set("u_ds", 1 / 60.0F);
            return [&canvas, program, vertices, format, at_beat, volume](int frame) {
              if (frame >= 10 && frame % 3 == 1) {
                const float beat = std::sin(1.3F * static_cast<float>(frame - 9));
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                canvas.gl.BindTexture(GL_TEXTURE_3D, volume);
                replace_texels(canvas, part_of(at_beat(beat), 12, 6, 8, 28, 28, 30), format, 12, 6, 8);
              }
              const Camera camera =
                  camera_at({.azimuth = 200, .elevation = 12, .distance = 2.5F, .degrees_each_frame = 2}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const float dragged = static_cast<float>(frame);
              canvas.begin(0.05F, 0.05F, 0.08F);
              program.use();
              program.set("clip_from_object", camera.clip_from_object());
              program.set("u_eye", camera.eye);
              program.set("u_level", -250 + 300 * std::sin(0.3F * dragged));
              program.set("u_window", 1600 - 45 * dragged);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
