// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {
namespace {

constexpr const char* bones_vertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 toClip;
layout(location = 0) out VertexData { vec3 place; } vs;
void main() {
  vs.place = position;
  gl_Position = toClip * vec4(position, 1.0);
}
)";

constexpr const char* bones_fragment = R"(#version 450 core
layout(binding = 3) uniform sampler3D field;
layout(binding = 4) uniform sampler1D palette;
layout(location = 1) uniform vec3 viewer;
layout(location = 2) uniform float delta;
layout(location = 0) in VertexData { vec3 place; } fs;
layout(location = 0) out vec4 result;

vec4 classify(vec3 p) {
  vec4 c = texture(palette, textureLod(field, p, 0.0).r);
  return vec4(c.rgb * c.a, c.a);
}

void main() {
  const vec3 d = normalize(fs.place - viewer);
  const vec3 exits = max((vec3(0) - fs.place) / d, (vec3(1) - fs.place) / d);
  const float range = min(min(exits.x, exits.y), exits.z);
  vec4 acc = vec4(0);
  float s = 0.5 * delta;
  while (s < range) {
    acc = acc + (1.0 - acc.a) * classify(fs.place + s * d);
    s += delta;
  }
  result = acc;
}
)";

/// Empty below 0.5.
std::vector<Colour> bone_table(float opacity) {
  std::vector<Colour> table;
  for (int i = 0; i < 256; ++i) {
    const float at = static_cast<float>(i) / 255, bone = std::clamp((at - 0.5F) / 0.3F, 0.0F, 1.0F);
    table.push_back({static_cast<std::uint8_t>(150 + 100 * bone), static_cast<std::uint8_t>(110 + 120 * bone),
                     static_cast<std::uint8_t>(80 + 110 * at),
                     static_cast<std::uint8_t>(std::lround(110 * opacity * bone))});
  }
  return table;
}

/// 64 entries, empty above 0.55.
std::vector<Colour> fog_table() {
  std::vector<Colour> table;
  for (int i = 0; i < 64; ++i) {
    const float at = static_cast<float>(i) / 63;
    const float thick = std::exp(-std::pow((at - 0.3F) / 0.13F, 2.0F));
    table.push_back({static_cast<std::uint8_t>(30 + 90 * at), static_cast<std::uint8_t>(220 - 150 * at),
                     static_cast<std::uint8_t>(140 + 100 * at),
                     static_cast<std::uint8_t>(std::lround(at > 0.55F ? 0 : 30 * thick))});
  }
  return table;
}

}  // namespace

Scenario change_tables_exchanged_glsl_450() {
  return {.sentence =
              "GLSL 4.50 with bindings and locations. The table's opacity fades in by glTexSubImage1D in "
              "frames 0 to "
              "8; from frame 9 to 17 another texture object of 64 entries takes its place, which shows only "
              "what was "
              "empty; at frame 12, while it is not bound to its unit, 40 empty entries of the first become "
              "green, to "
              "be seen from frame 18 on; from frame 22 on it fades out again.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 18, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, bones_vertex, bones_fragment);
            const VertexBuffer vertices(canvas);
            const Field skull = [](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.52F, c = z - 0.48F;
              const float distance = std::sqrt(a * a + 1.2F * b * b + 0.9F * c * c);
              const float wall = 0.75F * std::exp(-220 * (distance - 0.36F) * (distance - 0.36F));
              const float inner = 0.3F + 0.13F * std::sin(10 * x + 3 * z) * std::cos(8 * y - 2) +
                                  0.1F * std::sin(14 * z - 6 * x * y);
              return std::clamp(wall + inner, 0.0F, 1.0F);
            };
            upload_volume(canvas, 3, sampled(56, skull));
            const GLuint first = upload_table_1d(canvas, 4, bone_table(0.1F));
            const GLuint second = upload_table_1d(canvas, 4, fog_table());
            return [&canvas, program, vertices, first, second](int frame) {
              const Gl& gl = canvas.gl;
              const auto edit = [&](int unit, int from, const std::vector<Colour>& colours) {
                gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
                gl.BindTexture(GL_TEXTURE_1D, first);
                gl.TexSubImage1D(GL_TEXTURE_1D, 0, from, static_cast<GLsizei>(colours.size()), GL_RGBA,
                                 GL_UNSIGNED_BYTE, colours.data());
              };
              if (frame <= 8) edit(4, 0, bone_table(0.1F + 0.1125F * static_cast<float>(frame)));
              if (frame == 12) edit(9, 60, std::vector<Colour>(40, Colour{40, 230, 60, 12}));
              if (frame >= 22)
                edit(4, 128, [&] {
                  const std::vector<Colour> faded = bone_table(1 - 0.12F * static_cast<float>(frame - 21));
                  return std::vector<Colour>(faded.begin() + 128, faded.end());
                }());
              gl.ActiveTexture(GL_TEXTURE4);
              gl.BindTexture(GL_TEXTURE_1D, frame >= 9 && frame < 18 ? second : first);
              const Camera camera =
                  camera_at({.azimuth = 75, .elevation = -22, .degrees_each_frame = 3}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.2F, 0.2F, 0.22F);
              program.use();
              gl.UniformMatrix4fv(0, 1, GL_FALSE, camera.clip_from_object().data());
              gl.Uniform3f(1, camera.eye.x, camera.eye.y, camera.eye.z);
              gl.Uniform1f(2, 0.018F);
              set_blending(gl, Blending::premultiplied_over);
              gl.Enable(GL_CULL_FACE);
              gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
