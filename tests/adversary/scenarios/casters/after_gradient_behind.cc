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

Scenario after_gradient_behind() {
  return {
      .sentence =
          "Smoke of 36 x 56 x 36 bytes in GLSL 4.30, blending off: the composed colour is mixed with a "
          "gradient "
          "from below to above, by gl_FragCoord over the window's height. The window is cleared to the lower "
          "colour; in the first frames the box is small and low, where the gradient has hardly begun, and "
          "comes nearer.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 clip;
layout(location = 0) out vec3 start;
void main() {
  start = position;
  gl_Position = clip * vec4(position, 1.0);
}
)",
                                  R"(#version 430 core
layout(binding = 0) uniform sampler3D smoke;
layout(binding = 1) uniform sampler2D ramp;
uniform vec3 origin;
uniform float ds;
uniform vec2 resolution;
uniform vec3 below;
uniform vec3 above;
layout(location = 0) in vec3 start;
layout(location = 0) out vec4 result;

void main() {
  vec3 d = normalize(start - origin);
  vec3 t = max((vec3(0.0) - start) / d, (vec3(1.0) - start) / d);
  int n = int(floor(min(t.x, min(t.y, t.z)) / ds));
  vec3 c = vec3(0.0);
  float through = 1.0;
  for (int i = 0; i <= n; i++) {
    vec4 e = texture(ramp, vec2(texture(smoke, start + float(i) * ds * d).r, 0.5));
    c += through * e.a * e.rgb;
    through *= 1.0 - e.a;
    if (through < 0.01) break;
  }
  vec3 background = mix(below, above, smoothstep(0.3, 1.0, gl_FragCoord.y / resolution.y));
  result = vec4(c + through * background, 1.0);
}
)");
        const VertexBuffer vertices(canvas);
        const Field smoke = [](float x, float y, float z) {
          const float a = x - 0.5F - 0.1F * std::sin(8 * y), b = z - 0.5F - 0.1F * std::cos(7 * y + 1);
          const float plume = std::exp(-(a * a + b * b) / (0.012F + 0.06F * y));
          return std::clamp(plume * (0.75F + 0.3F * std::sin(19 * y + 9 * x - 11 * z)), 0.0F, 1.0F);
        };
        std::vector<Colour> ramp;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          ramp.push_back({static_cast<std::uint8_t>(200 - 120 * at), static_cast<std::uint8_t>(190 - 100 * at),
                          static_cast<std::uint8_t>(200 - 60 * at),
                          static_cast<std::uint8_t>(std::lround(28 * at))});
        }
        upload_volume(canvas, 0, sampled(36, 56, 36, smoke));
        upload_table_2d(canvas, 1, ramp);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 10,
                            .elevation = 14 - 0.5F * static_cast<float>(frame),
                            .distance = 4.4F - 0.06F * static_cast<float>(frame),
                            .degrees_each_frame = 2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          Matrix lower = identity;
          lower[13] = -0.45F + 0.015F * static_cast<float>(frame);
          canvas.begin(0.25F, 0.3F, 0.35F);
          program.use();
          program.set("clip", lower * camera.clip_from_object());
          program.set("origin", camera.eye);
          program.set("ds", 0.0175F);
          canvas.gl.Uniform2f(program.location("resolution"), static_cast<float>(canvas.width()),
                              static_cast<float>(canvas.height()));
          program.set("below", Vector{0.25F, 0.3F, 0.35F});
          program.set("above", Vector{0.9F, 0.6F, 0.3F});
          set_blending(canvas.gl, Blending::off);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
