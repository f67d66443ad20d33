// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::slices {
namespace {

/// Kelvin / 1000.
float flame(float x, float y, float z) {
  const float u = x - 0.5F - 0.12F * std::sin(7 * y), v = z - 0.5F - 0.1F * std::cos(6 * y + 1);
  const float width = 0.3F * (1.1F - y);
  const float body = std::exp(-(u * u + v * v) / (width * width));
  return 0.3F + 1.9F * body * (0.5F + 0.5F * waves(x, y, z)) * (0.4F + 0.6F * std::sin(3.1F * y));
}

std::vector<Colour> black_body() {
  std::vector<Colour> colours;
  for (int i = 0; i < 256; ++i) {
    const float at = static_cast<float>(i) / 255;
    colours.push_back({static_cast<std::uint8_t>(255 * std::min(1.0F, 0.2F + 1.4F * at)),
                       static_cast<std::uint8_t>(255 * std::min(1.0F, 1.3F * at * at)),
                       static_cast<std::uint8_t>(200 * at * at * at), static_cast<std::uint8_t>(60 * at)});
  }
  return colours;
}

struct Furnace {
  explicit Furnace(Canvas& canvas)
      : glow(canvas, R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 3) uniform mat4 worldToClip;
layout(location = 0) out vec3 p;
void main() { p = position; gl_Position = worldToClip * vec4(p, 1.0); }
)",
             R"(#version 430 core
layout(binding = 0) uniform sampler3D temperature;
layout(binding = 4) uniform sampler2D blackBody;
layout(location = 8) uniform float hottest;
layout(location = 9) uniform float gain;
layout(location = 0) in vec3 p;
layout(location = 0) out vec4 light;
void main() {
  float kilokelvin = texture(temperature, p).r;
  light = texture(blackBody, vec2(kilokelvin / hottest, 0.5));
  light.a *= gain;
}
)"),
        wall(canvas, R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 worldToClip;
out vec3 p;
void main() { p = position; gl_Position = worldToClip * vec4(p, 1.0); }
)",
             R"(#version 430 core
in vec3 p;
out vec4 light;
void main() { light = vec4(0.25 * p.x + 0.05, 0.15, 0.3 * p.y, 1.0); }
)"),
        vertices(canvas) {
    upload_volume(canvas, 0, sampled(40, 56, 40, flame), {.texel = Texel::half});
    upload_table_2d(canvas, 4, black_body());
  }
  GlslProgram glow, wall;
  VertexBuffer vertices;
};

}  // namespace

Scenario stack_flame_among_walls() {
  return {.sentence =
              "Light added up (SRC_ALPHA, ONE) from slices of half floats among opaque walls, alpha masked; "
              "fewer slices "
              "of more gain from frame 10 to 19, and another temperature is the hottest from frame 15 on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 15, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, furnace = std::make_shared<Furnace>(canvas)](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera =
                  camera_at({.azimuth = 70, .elevation = 10, .degrees_each_frame = 3}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.02F, 0.02F, 0.05F);
              gl.Enable(GL_DEPTH_TEST);
              gl.DepthFunc(GL_LESS);
              gl.Disable(GL_BLEND);
              furnace->wall.use();
              furnace->wall.set("worldToClip", camera.clip_from_object());
              furnace->vertices.draw(std::vector<Vector>{{0.15F, 0, 0.55F},
                                                         {0.55F, 0, 0.2F},
                                                         {0.3F, 0.9F, 0.4F},
                                                         {0.6F, 0.1F, 0.9F},
                                                         {1.2F, 0.2F, 0.5F},
                                                         {0.8F, 0.8F, 0.6F}});
              const bool coarse = frame >= 10 && frame < 20;
              gl.DepthMask(GL_FALSE);
              gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
              gl.Enable(GL_BLEND);
              gl.BlendEquation(GL_FUNC_ADD);
              gl.BlendFunc(GL_SRC_ALPHA, GL_ONE);
              furnace->glow.use();
              furnace->glow.set("worldToClip", camera.clip_from_object());
              furnace->glow.set("hottest", frame < 15 ? 2.2F : 1.7F);
              furnace->glow.set("gain", coarse ? 1.0F : 0.5F);
              furnace->vertices.draw(triangles(view_aligned_slices(camera, coarse ? 30 : 60)));
              gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
              gl.DepthMask(GL_TRUE);
              gl.Disable(GL_DEPTH_TEST);
            };
          }};
}

}  // namespace adversary::slices
