// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
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

float tooth(float x, float y, float z) {
  const float u = x - 0.5F, v = y - 0.48F;
  const float crown = 0.34F + 0.06F * std::cos(4 * std::atan2(v, u)) - 0.25F * std::max(0.0F, 0.6F - z);
  const float radius = std::sqrt(u * u + v * v);
  const float dentin = 1 / (1 + std::exp(45 * (radius - crown)));
  const float pulp = std::exp(-90 * (radius - 0.05F) * (radius - 0.05F));
  return std::clamp(dentin * (0.45F + 0.25F * waves(x, y, z) + 0.25F * z) - 0.3F * pulp, 0.0F, 1.0F);
}

struct ToothViewer {
  explicit ToothViewer(Canvas& canvas)
      : ray(canvas, R"(#version 330
in vec3 position;
uniform mat4 modelViewProjection;
smooth out vec3 texcoord;
void main() {
  gl_Position = modelViewProjection * vec4(texcoord = position, 1);
}
)",
            R"(#version 330
uniform sampler3D scalars;
uniform sampler1D colorTransfer;
uniform sampler1D opacityTransfer;
uniform vec2 windowLevel;   // scale, bias
uniform float sampleDistance;
smooth in vec3 texcoord;
out vec4 fragmentColor;
void main() {
  float s = windowLevel.x * texture(scalars, texcoord).r + windowLevel.y;
  vec3 rgb = texture(colorTransfer, s).rgb;
  float a = texture(opacityTransfer, s).a;
  a = 1.0 - exp(log(1.0 - min(a, 0.99)) * sampleDistance);
  fragmentColor = vec4(a * rgb, a);
}
)"),
        backdrop(canvas, R"(#version 330
in vec3 position;
out float height;
void main() {
  height = 0.5 * position.y + 0.5;
  gl_Position = vec4(position, 1.0);
}
)",
                 R"(#version 330
in float height;
out vec4 fragmentColor;
void main() { fragmentColor = vec4(mix(vec3(0.75, 0.72, 0.6), vec3(0.15, 0.25, 0.5), height), 1.0); }
)"),
        vertices(canvas) {
    upload_volume(canvas, 0, sampled(48, tooth));
    std::vector<Colour> colours, opacities;
    for (int i = 0; i < 128; ++i) {
      const float at = static_cast<float>(i) / 127;
      colours.push_back({static_cast<std::uint8_t>(120 + 135 * at),
                         static_cast<std::uint8_t>(40 + 200 * at * at),
                         static_cast<std::uint8_t>(150 - 90 * std::sin(5 * at)), 255});
      if (i % 4 == 0) opacities.push_back({0, 0, 0, static_cast<std::uint8_t>(at < 0.2F ? 0 : 120 * at * at)});
    }
    upload_table_1d(canvas, 2, colours);
    upload_table_1d(canvas, 3, opacities);
  }
  GlslProgram ray, backdrop;
  VertexBuffer vertices;
};

}  // namespace

Scenario stack_tooth_before_its_background() {
  return {.sentence =
              "Axis-aligned slices front to back over a clear window, colours and opacities from two tables, "
              "window "
              "and level changing every fourth frame; the background is blended behind them last.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {4, 8, 12, 16, 20, 24, 28},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, viewer = std::make_shared<ToothViewer>(canvas)](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera =
                  camera_at({.azimuth = 20, .elevation = 35, .distance = 2.3F, .degrees_each_frame = 2}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0, 0, 0, 0);
              gl.Enable(GL_BLEND);
              gl.BlendEquation(GL_FUNC_ADD);
              gl.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
              const int slices = frame < 16 ? 48 : 70;
              viewer->ray.use();
              viewer->ray.set("scalars", 0);
              viewer->ray.set("colorTransfer", 2);
              viewer->ray.set("opacityTransfer", 3);
              viewer->ray.set("modelViewProjection", camera.clip_from_object());
              viewer->ray.set("sampleDistance", 48.0F / static_cast<float>(slices));
              const float width = 0.6F + 0.1F * static_cast<float>(frame / 4 % 5);
              const float level = 0.55F - 0.06F * static_cast<float>(frame / 4 % 3);
              gl.Uniform2f(viewer->ray.location("windowLevel"), 1 / width, 0.5F - level / width);
              viewer->vertices.draw(triangles(axis_aligned_slices(camera, slices, Order::front_to_back)));
              viewer->backdrop.use();
              viewer->vertices.draw(std::array<Vector, 4>{Vector{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                                    GL_TRIANGLE_STRIP);
            };
          }};
}

}  // namespace adversary::slices
