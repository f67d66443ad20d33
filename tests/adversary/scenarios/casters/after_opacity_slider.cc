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

Scenario after_opacity_slider() {
  return {.sentence =
              "A comet of 64 x 32 x 32 floats in GLSL 4.10, all of what a ray composed is multiplied by the "
              "opacity of a slider, colour and alpha: 0.6 at first, 0.3 from frame 10 on, 1 from frame 20 on. "
              "It is thin where it is seen first, and nearly opaque on the side that turns into view.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 uMvp;
out vec3 vPos;
void main() {
  vPos = position;
  gl_Position = uMvp * vec4(position, 1.0);
}
)",
                                      R"(#version 410 core
uniform sampler3D uVolume;
uniform sampler1D uTransfer;
uniform vec3 uEye;
uniform float uDt;
uniform float uOpacity;
in vec3 vPos;
layout(location = 0) out vec4 fragColor;

bool outside(vec3 p) { return any(notEqual(p, clamp(p, 0.0, 1.0))); }

vec4 march(vec3 p, vec3 dp) {
  vec4 dst = vec4(0.0);
  while (!outside(p)) {
    vec4 src = texture(uTransfer, texture(uVolume, p).x);
    float w = (1.0 - dst.a) * src.a;
    dst.rgb += w * src.rgb;
    dst.a += w;
    p += dp;
  }
  return dst;
}

void main() {
  vec3 dir = normalize(vPos - uEye);
  fragColor = uOpacity * march(vPos + 0.5 * uDt * dir, uDt * dir);
}
)");
            const VertexBuffer vertices(canvas);
            const Field comet = [](float x, float y, float z) {
              const float a = y - 0.5F, b = z - 0.5F;
              const float round = std::sqrt(a * a + b * b);
              const float head = std::exp(-30 * ((x - 0.8F) * (x - 0.8F) + a * a + b * b));
              const float tail = 0.3F * std::exp(-std::pow(round / (0.45F - 0.2F * x), 2.0F)) *
                                 (0.8F + 0.4F * std::sin(17 * x + 6 * std::atan2(b, a)));
              return std::clamp(head + tail, 0.0F, 1.0F);
            };
            std::vector<Colour> colours;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              colours.push_back({static_cast<std::uint8_t>(120 + 130 * at),
                                 static_cast<std::uint8_t>(150 + 90 * at * at),
                                 static_cast<std::uint8_t>(250 - 170 * at),
                                 static_cast<std::uint8_t>(std::lround(120 * at * at + 6 * at))});
            }
            upload_volume(canvas, 0, sampled(64, 32, 32, comet), {.texel = Texel::float32});
            upload_table_1d(canvas, 1, colours);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = -80, .elevation = 16, .distance = 2.5F, .degrees_each_frame = 6};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.04F, 0.05F, 0.1F);
              program.use();
              program.set("uVolume", 0);
              program.set("uTransfer", 1);
              program.set("uMvp", camera.clip_from_object());
              program.set("uEye", camera.eye);
              program.set("uDt", 0.0175F);
              program.set("uOpacity", frame < 10 ? 0.6F : frame < 20 ? 0.3F : 1.0F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
