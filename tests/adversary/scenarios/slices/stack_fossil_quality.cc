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

constexpr Vector fossil_extent{1, 0.8F, 0.6F};  // of the specimen in the world; its middle is (0.5, 0.5, 0.5)

float ammonite(float x, float y, float z) {
  const float u = x - 0.48F, v = y - 0.53F, w = z - 0.5F;
  const float radius = std::sqrt(u * u + v * v), angle = std::atan2(v, u);
  const float whorl = std::sin(18 * std::log(radius + 0.08F) - angle);
  const float rib = 0.15F * std::sin(17 * angle + 9 * radius);
  return std::clamp(0.5F + 0.33F * whorl + rib - 1.4F * w * w + 0.1F * std::sin(11 * w + 4 * x), 0.0F, 1.0F);
}

/// Two thin layers show, all else is clear.
std::vector<Colour> two_layers() {
  std::vector<Colour> colours;
  for (int i = 0; i < 256; ++i) {
    const float at = static_cast<float>(i) / 255;
    const float shell = std::max(0.0F, 1 - std::abs(at - 0.38F) / 0.03F);
    const float core = std::max(0.0F, 1 - std::abs(at - 0.78F) / 0.05F);
    colours.push_back({static_cast<std::uint8_t>(at < 0.6F ? 225 - 60 * at : 70),
                       static_cast<std::uint8_t>(at < 0.6F ? 170 : 110 + 90 * at),
                       static_cast<std::uint8_t>(at < 0.6F ? 110 + 100 * at : 235),
                       static_cast<std::uint8_t>(90 * shell + 200 * core)});
  }
  return colours;
}

struct Specimen {
  explicit Specimen(Canvas& canvas)
      : program(canvas, R"(#version 420 core
layout(location = 0) in vec3 position;
uniform mat4 u_mvp;
out Piece { vec3 uvw; } piece;
void main() {
  piece.uvw = position;
  gl_Position = u_mvp * vec4(position, 1.0);
}
)",
                R"(#version 420 core
layout(binding = 0) uniform sampler3D u_density;
layout(binding = 1) uniform sampler1D u_palette;
uniform float u_step;
const float u_reference = 1.0 / 64.0;
in Piece { vec3 uvw; } piece;
layout(location = 0) out vec4 o_pixel;
void main() {
  vec4 entry = texture(u_palette, texture(u_density, piece.uvw).x);
  float opacity = 1.0 - pow(1.0 - entry.a, u_step / u_reference);
  if (opacity < 0.002) discard;
  o_pixel = vec4(entry.rgb * opacity, opacity);
}
)"),
        vertices(canvas) {
    upload_volume(canvas, 0, sampled(64, 40, 32, ammonite), {.texel = Texel::unsigned16});
    upload_table_1d(canvas, 1, two_layers());
  }
  GlslProgram program;
  VertexBuffer vertices;
};

}  // namespace

Scenario stack_fossil_quality() {
  return {.sentence =
              "View-aligned slices between the nearest and the farthest corner of an anisotropic box, "
              "premultiplied, "
              "40, 72 or 120 of them; a uniform tells how far apart they are, in every frame.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {6, 12, 18, 24},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, specimen = std::make_shared<Specimen>(canvas)](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera =
                  camera_at({.azimuth = -50, .elevation = 25, .distance = 2.1F, .degrees_each_frame = 4}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              // The plane dot(forward, world) == d, in texture coordinates.
              const Vector n = camera.forward;
              const Vector normal{n.x * fossil_extent.x, n.y * fossil_extent.y, n.z * fossil_extent.z};
              const float half = 0.5F * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
              const float middle = 0.5F * (normal.x + normal.y + normal.z);
              constexpr int counts[3] = {40, 72, 120};
              const int count = counts[frame / 6 % 3];
              const float step = 2 * half / static_cast<float>(count);
              std::vector<Polygon> polygons;
              for (int i = 0; i < count; ++i) {
                Polygon polygon = cut_box(normal, middle + half - (static_cast<float>(i) + 0.5F) * step);
                if (polygon.size() >= 3) polygons.push_back(std::move(polygon));
              }
              Matrix model = identity;
              model[0] = fossil_extent.x;
              model[5] = fossil_extent.y;
              model[10] = fossil_extent.z;
              model[12] = 0.5F - 0.5F * fossil_extent.x;
              model[13] = 0.5F - 0.5F * fossil_extent.y;
              model[14] = 0.5F - 0.5F * fossil_extent.z;
              canvas.begin(0.93F, 0.91F, 0.86F);
              specimen->program.use();
              specimen->program.set("u_mvp", camera.clip_from_object() * model);
              specimen->program.set("u_step", step);
              gl.Enable(GL_BLEND);
              gl.BlendEquation(GL_FUNC_ADD);
              gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
              specimen->vertices.draw(triangles(polygons));
            };
          }};
}

}  // namespace adversary::slices
