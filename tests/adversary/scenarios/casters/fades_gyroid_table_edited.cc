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

Scenario fades_gyroid_table_edited() {
  return {.sentence =
              "A gyroid of 44 x 44 x 44 floats that steepens to one side, GLSL 4.00, not lit; opacity by a "
              "narrow peak in 256 floats, looked up by the gradient's length in texture space; at frame 12 "
              "the user moves the peak.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 corner;
uniform mat4 clipFromBox;
out vec3 entry;
void main() {
  entry = corner;
  gl_Position = clipFromBox * vec4(corner, 1.0);
}
)",
                                      R"(#version 400 core
in vec3 entry;
layout(location = 0) out vec4 fragment;
uniform sampler3D field;
uniform sampler2D colours;
uniform sampler2D steepness;
uniform vec3 eye;
uniform float spacing;
uniform float stepLength;
uniform float gradientScale;

vec3 gradient(vec3 p) {
  vec2 h = vec2(spacing, 0.0);
  return vec3(texture(field, p + h.xyy).r - texture(field, p - h.xyy).r,
              texture(field, p + h.yxy).r - texture(field, p - h.yxy).r,
              texture(field, p + h.yyx).r - texture(field, p - h.yyx).r) / (2.0 * spacing);
}

void main() {
  vec3 direction = normalize(entry - eye);
  vec3 ends = (step(0.0, direction) - entry) / direction;
  float last = min(ends.x, min(ends.y, ends.z));
  vec3 light = vec3(0.0);
  float opacity = 0.0;
  for (float t = 0.5 * stepLength; t < last; t += stepLength) {
    vec3 p = entry + t * direction;
    vec4 c = texture(colours, vec2(texture(field, p).r, 0.5));
    float alpha = c.a * texture(steepness, vec2(gradientScale * length(gradient(p)), 0.5)).r;
    light += (1.0 - opacity) * alpha * c.rgb;
    opacity += (1.0 - opacity) * alpha;
  }
  fragment = vec4(light, opacity);
}
)");
            const VertexBuffer vertices(canvas);
            const Field gyroid = [](float x, float y, float z) {
              const float u = 8 * x + 0.4F, v = 8 * y + 1, w = 8 * z;
              const float sheet =
                  std::sin(u) * std::cos(v) + std::sin(v) * std::cos(w) + std::sin(w) * std::cos(u);
              return 0.5F + (0.06F + 0.2F * x) * sheet;
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float middle = std::exp(-std::pow((at - 0.5F) / 0.2F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(250 - 190 * at),
                               static_cast<std::uint8_t>(80 + 130 * middle),
                               static_cast<std::uint8_t>(40 + 200 * at),
                               static_cast<std::uint8_t>(std::lround(4 + 46 * middle))});
            }
            const auto peak_at = [](float centre) {
              std::vector<float> factors;
              for (int i = 0; i < 256; ++i) {
                const float at = static_cast<float>(i) / 255;
                factors.push_back(std::max(0.0F, 1 - std::abs(at - centre) / 0.22F));
              }
              return factors;
            };
            upload_volume(canvas, 0, sampled(44, gyroid), {.texel = Texel::float32});
            upload_table_2d(canvas, 1, table);
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_2D, name);
            filter_linearly(canvas, GL_TEXTURE_2D);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, 256, 1, 0, GL_RED, GL_FLOAT, peak_at(0.38F).data());
            return [&canvas, program, vertices, peak_at](int frame) {
              if (frame == 12) {
                const auto factors = peak_at(0.75F);
                canvas.gl.ActiveTexture(GL_TEXTURE2);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RED, GL_FLOAT, factors.data());
              }
              const Orbit orbit{.azimuth = 20, .elevation = 26, .distance = 2.5F, .degrees_each_frame = 1.5F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.08F, 0.1F, 0.14F);
              program.use();
              program.set("clipFromBox", camera.clip_from_object());
              program.set("eye", camera.eye);
              program.set("field", 0);
              program.set("colours", 1);
              program.set("steepness", 2);
              program.set("spacing", 1 / 44.0F);
              program.set("stepLength", 0.018F);
              program.set("gradientScale", 0.3F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
