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

/// Hounsfield units, from -1000 on.
float knee(float x, float y, float z) {
  const float u = x - 0.45F - 0.1F * std::sin(4 * z), v = y - 0.5F + 0.08F * std::cos(5 * z);
  const float radius = std::sqrt(u * u + v * v) + 0.05F * std::sin(9 * z + 3 * std::atan2(v, u));
  const float joint = std::exp(-300 * (z - 0.52F - 0.2F * u * u) * (z - 0.52F - 0.2F * u * u));
  const float flesh = 1 / (1 + std::exp(40 * (radius - 0.42F))),
              bone = 1 / (1 + std::exp(60 * (radius - 0.2F)));
  return -1000 + flesh * (950 + 160 * waves(x, y, z)) + bone * (1 - joint) * (700 + 900 * shells(x, y, z));
}

std::vector<Colour> knee_presets() {
  std::vector<Colour> rows;
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
  };
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 200; ++i) {
      const float at = static_cast<float>(i) / 199;
      const float first = 0.28F + 0.1F * static_cast<float>(row);  // where it begins to show
      const float rise = std::clamp((at - first) / (row == 1 ? 0.02F : 0.2F), 0.0F, 1.0F);
      rows.push_back({byte(0.9F - 0.2F * static_cast<float>(row) * at), byte(0.3F + 0.6F * at),
                      byte(0.2F + 0.25F * static_cast<float>(row) + 0.3F * std::sin(9 * at)),
                      byte((row == 3 ? 0.9F : 0.25F) * rise)});
    }
  return rows;
}

struct Workstation {
  explicit Workstation(Canvas& canvas)
      : piece(canvas, R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 toClip;
out gl_PerVertex { vec4 gl_Position; };
layout(location = 2) out vec3 where;
void main() { where = position; gl_Position = toClip * vec4(position, 1.0); }
)",
              R"(#version 450 core
layout(binding = 2) uniform sampler3D hounsfield;
layout(binding = 3) uniform sampler2D presets;
layout(location = 4) uniform int preset;
layout(location = 5) uniform float slices;
layout(location = 6) uniform float least;
layout(location = 2) in vec3 where;
layout(location = 0) out vec4 shade;
const vec2 range = vec2(-1000.0, 1800.0);
void main() {
  float hu = textureLod(hounsfield, where, 0.0).r;
  if (hu < least) discard;
  float t = (hu - range.x) / (range.y - range.x);
  vec4 classified = textureLod(presets, vec2(t, (float(preset) + 0.5) / 4.0), 0.0);
  shade.rgb = classified.rgb;
  shade.a = 1.0 - pow(max(1.0 - classified.a, 1e-4), 100.0 / slices);
}
)"),
        implant(canvas, R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 toClip;
out vec3 where;
void main() { where = position; gl_Position = toClip * vec4(position, 1.0); }
)",
                R"(#version 450 core
in vec3 where;
out vec4 shade;
void main() { shade = vec4(0.6 + 0.4 * sin(40.0 * where.z), 0.65, 0.7, 1.0); }
)"),
        vertices(canvas) {
    upload_volume(canvas, 2, sampled(48, 40, 56, knee), {.texel = Texel::float32});
    upload_table_2d(canvas, 3, knee_presets(), 4);
  }
  GlslProgram piece, implant;
  VertexBuffer vertices;
};

}  // namespace

Scenario stack_knee_presets_in_rows() {
  return {.sentence =
              "Slices of Hounsfield units as floats, dense and straight alpha, that write depth behind and "
              "before an "
              "opaque screw; presets are rows of one 2-D texture, and change every fifth frame with the lowest "
              "value "
              "that is not discarded and the number of slices.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {5, 10, 15, 20, 25},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, station = std::make_shared<Workstation>(canvas)](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera =
                  camera_at({.azimuth = 10, .elevation = -25, .distance = 2.0F, .degrees_each_frame = 5}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.3F, 0.3F, 0.35F);
              gl.Enable(GL_DEPTH_TEST);
              gl.DepthFunc(GL_LEQUAL);
              gl.DepthMask(GL_TRUE);
              gl.Disable(GL_BLEND);
              station->implant.use();
              station->implant.set("toClip", camera.clip_from_object());
              station->vertices.draw(std::vector<Vector>{{0.4F, 0.45F, -0.1F},
                                                         {0.5F, 0.55F, -0.1F},
                                                         {0.45F, 0.4F, 1.1F},
                                                         {0.05F, 0.5F, 0.45F},
                                                         {0.1F, 0.9F, 0.6F},
                                                         {0.95F, 0.6F, 0.5F}});
              constexpr float slices[3] = {100, 64, 160};
              const int preset = frame / 5 % 4;
              const float count = slices[frame / 5 % 3];
              gl.Enable(GL_BLEND);
              gl.BlendEquation(GL_FUNC_ADD);
              gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
              station->piece.use();
              station->piece.set("toClip", camera.clip_from_object());
              station->piece.set("preset", preset);
              station->piece.set("slices", count);
              station->piece.set("least", -150 + 150 * static_cast<float>(preset));
              station->vertices.draw(triangles(view_aligned_slices(camera, static_cast<int>(count))));
              gl.Disable(GL_DEPTH_TEST);
            };
          }};
}

}  // namespace adversary::slices
