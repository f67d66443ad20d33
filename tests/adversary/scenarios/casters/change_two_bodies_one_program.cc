// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {
namespace {

constexpr const char* bodies_vertex = R"(#version 140
in vec3 position;
uniform mat4 viewProjection;
uniform vec3 offset;
out vec3 texcoord;
void main()
{
  texcoord = position;
  gl_Position = viewProjection * vec4(position + offset, 1.0);
}
)";

constexpr const char* bodies_fragment = R"(#version 140
uniform sampler3D volumeTexture;
uniform sampler2D transferTexture;
uniform vec3 localCamera;
uniform float valueScale;
uniform float opacityScale;
uniform float ds;
in vec3 texcoord;
out vec4 outColor;

void main()
{
  vec3 v = normalize(texcoord - localCamera);
  vec3 e = (step(vec3(0.0), v) - texcoord) / v;
  float last = min(e.x, min(e.y, e.z));
  vec4 result = vec4(0.0);
  for (float t = 0.5 * ds; t < last; t += ds) {
    float value = valueScale * texture(volumeTexture, texcoord + t * v).x;
    vec4 src = textureLod(transferTexture, vec2(value, 0.5), 0.0);
    src.a *= opacityScale;
    src.rgb *= src.a;
    result = (1.0 - result.a) * src + result;
    if (result.a > 0.995) break;
  }
  outColor = result;
}
)";

}  // namespace

Scenario change_two_bodies_one_program() {
  return {
      .sentence =
          "Two volumes, 40 x 48 x 44 bytes and 36 x 32 x 56 of 12 bits in 16, each with a table of its own, "
          "drawn "
          "by one program: beside each other in frames 0 to 9, then in turn at one place, from frame 20 on "
          "beside "
          "each other at exchanged places; the second's opacity swells from frame 5 on.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {5, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 24, 28},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, bodies_vertex, bodies_fragment);
        const VertexBuffer vertices(canvas);
        const Field apple = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.5F, c = z - 0.5F;
          const float distance = std::sqrt(a * a + b * b + c * c);
          return std::clamp(0.6F / (1 + std::exp(40 * (distance - 0.4F))) +
                                0.2F * std::sin(18 * distance + 3 * x) + 0.1F * std::sin(9 * y + 4 * z) + 0.15F,
                            0.0F, 1.0F);
        };
        const Field pear = [](float x, float y, float z) {
          const float sum =
              std::sin(9 * x - 4 * z) + std::cos(7 * y + 5 * z) + 0.7F * std::sin(13 * z + 6 * x * y);
          return std::clamp(0.5F + 0.18F * sum, 0.0F, 1.0F) * 4095 / 65535;
        };
        const GLuint volumes[] = {
            upload_volume(canvas, 0, sampled(40, 48, 44, apple)),
            upload_volume(canvas, 0, sampled(36, 32, 56, pear), {.texel = Texel::unsigned16})};
        std::vector<Colour> red, green;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          red.push_back({static_cast<std::uint8_t>(120 + 130 * at),
                         static_cast<std::uint8_t>(40 + 150 * at * at), static_cast<std::uint8_t>(70 - 40 * at),
                         static_cast<std::uint8_t>(std::lround(60 * at * at))});
          green.push_back({static_cast<std::uint8_t>(30 + 60 * at), static_cast<std::uint8_t>(220 - 90 * at),
                           static_cast<std::uint8_t>(80 + 140 * at),
                           static_cast<std::uint8_t>(std::lround(2 + 24 * (1 - at)))});
        }
        const GLuint tables[] = {upload_table_2d(canvas, 1, red), upload_table_2d(canvas, 1, green)};
        program.use();
        program.set("volumeTexture", 0);
        program.set("transferTexture", 1);
        program.set("ds", 0.02F);
        return [&canvas, program, vertices, apple_volume = volumes[0], pear_volume = volumes[1],
                apple_table = tables[0], pear_table = tables[1]](int frame) {
          const Gl& gl = canvas.gl;
          const bool in_turn = frame >= 10 && frame < 20;
          const Camera camera = camera_at(
              {.azimuth = 10, .elevation = 18, .distance = in_turn ? 2.6F : 4.6F, .degrees_each_frame = 1.5F},
              frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const auto draw = [&](bool pear_body, Vector place) {
            gl.ActiveTexture(GL_TEXTURE0);
            gl.BindTexture(GL_TEXTURE_3D, pear_body ? pear_volume : apple_volume);
            gl.ActiveTexture(GL_TEXTURE1);
            gl.BindTexture(GL_TEXTURE_2D, pear_body ? pear_table : apple_table);
            program.set("valueScale", pear_body ? 65535 / 4095.0F : 1.0F);
            program.set(
                "opacityScale",
                pear_body ? 1 + 0.6F * std::sin(0.5F * static_cast<float>(std::max(frame - 4, 0))) : 1.0F);
            program.set("offset", place);
            program.set("localCamera", camera.eye - place);
            vertices.draw(box_triangles());
          };
          canvas.begin(0.08F, 0.08F, 0.1F);
          program.use();
          program.set("viewProjection", camera.clip_from_object());
          set_blending(gl, Blending::premultiplied_over);
          gl.Enable(GL_CULL_FACE);
          gl.CullFace(GL_BACK);
          if (in_turn) {
            draw(frame % 2 == 1, {0, 0, 0});
          } else {
            const Vector left{-0.58F, 0, 0}, right{0.58F, 0.1F, 0};
            draw(frame >= 20, left);
            draw(frame < 10, right);
          }
          gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
