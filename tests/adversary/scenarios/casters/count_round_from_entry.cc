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

Scenario count_round_from_entry() {
  return {.sentence =
              "A coil of 24 x 40 x 32 floats in GLSL 1.50, matrix, eye and step in a uniform block: as "
              "many samples as the ray's length divided by the step, rounded to the nearest, of this very "
              "step, the first at the entry.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 150
layout(std140) uniform Frame {
  mat4 clip_from_object;
  vec4 eye_and_step;
} frame;

in vec3 position;
out vec3 on_box;

void main() {
  on_box = position;
  gl_Position = frame.clip_from_object * vec4(position, 1.0);
}
)",
                                      R"(#version 150
layout(std140) uniform Frame {
  mat4 clip_from_object;
  vec4 eye_and_step;
} frame;

uniform sampler3D scalars;
uniform sampler2D colours;

in vec3 on_box;
out vec4 pixel;

void main() {
  vec3 eye = frame.eye_and_step.xyz;
  float dt = frame.eye_and_step.w;
  vec3 along = normalize(on_box - eye);

  vec3 a = -eye / along;
  vec3 b = (vec3(1.0) - eye) / along;
  vec3 near3 = min(a, b), far3 = max(a, b);
  float t_in = max(0.0, max(near3.x, max(near3.y, near3.z)));
  float t_out = min(far3.x, min(far3.y, far3.z));
  float span = max(t_out - t_in, 0.0);
  int count = int(span / dt + 0.5);

  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; i++) {
    float t = t_in + float(i) * dt;
    float s = texture(scalars, eye + t * along).r;
    vec4 c = texture(colours, vec2(s, 0.5));
    sum.rgb = sum.rgb + (1.0 - sum.a) * c.a * c.rgb;
    sum.a = sum.a + (1.0 - sum.a) * c.a;
  }
  pixel = sum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field coil = [](float x, float y, float z) {
              const float turn = 9 * y + 0.5F;
              const float a = x - 0.5F - 0.22F * std::cos(turn), b = z - 0.48F - 0.2F * std::sin(turn);
              return std::clamp(0.12F + 0.7F * std::exp(-20 * (a * a + b * b)) + 0.15F * y * x, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(225 - 100 * at),
                               static_cast<std::uint8_t>(60 + 120 * std::sin(3.0F * at)),
                               static_cast<std::uint8_t>(80 + 150 * at),
                               static_cast<std::uint8_t>(std::lround(4 + 30 * at + 20 * at * at))});
            }
            upload_volume(canvas, 0, sampled(24, 40, 32, coil), {.texel = Texel::float32});
            upload_table_2d(canvas, 1, table);
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, 20 * sizeof(float), nullptr, GL_DYNAMIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, block);
            canvas.gl.UniformBlockBinding(program.name(),
                                          canvas.gl.GetUniformBlockIndex(program.name(), "Frame"), 0);
            program.use();
            program.set("scalars", 0);
            program.set("colours", 1);
            return [&canvas, program, vertices, block](int frame) {
              const Orbit orbit{.azimuth = 110, .elevation = -22, .distance = 2.4F, .degrees_each_frame = 0.9F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.14F, 0.1F, 0.1F);
              const Matrix clip_from_object = camera.clip_from_object();
              std::vector<float> numbers(clip_from_object.begin(), clip_from_object.end());
              numbers.insert(numbers.end(), {camera.eye.x, camera.eye.y, camera.eye.z, 0.025F});
              canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
              canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0,
                                      static_cast<GLsizeiptr>(numbers.size() * sizeof(float)), numbers.data());
              program.use();
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
