// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario box_of_the_world_cropped() {
  return {.sentence =
              "The box is drawn in the world's coordinates, which the fragment shader maps to the texture's. "
              "From frame "
              "10 on its vertices show a part of the volume, from frame 20 on another part of that size.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
in vec3 position;
uniform mat4 worldToClip;
out vec3 world;
void main() {
  world = position;
  gl_Position = worldToClip * vec4(position, 1.0);
}
)",
                                      R"(#version 330 core
in vec3 world;
out vec4 fragment;
uniform sampler3D density;
uniform sampler2D lut;
uniform vec3 camera;
uniform vec3 low;
uniform vec3 high;
void main() {
  vec3 direction = normalize(world - camera);
  vec3 ends = max((low - world) / direction, (high - world) / direction);
  float length_of_ray = min(ends.x, min(ends.y, ends.z));
  vec4 sum = vec4(0.0);
  for (float t = 0.0; t <= length_of_ray; t += 0.02) {
    vec4 c = texture(lut, vec2(texture(density, (world + t * direction) / 0.8 + vec3(-0.125)).r, 0.5));
    sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
  }
  fragment = sum;
}
)");
            const VertexBuffer box(canvas);
            const Field field = [](float x, float y, float z) {
              return std::clamp(0.5F + 0.5F * std::sin(9 * x) * std::cos(7 * y + 2 * x) * std::sin(8 * z + 1),
                                0.0F, 1.0F);
            };
            std::vector<Colour> lut;
            lut.reserve(256);
            for (int i = 0; i < 256; ++i)
              lut.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i), 120,
                             static_cast<std::uint8_t>(i / 16)});
            upload_volume(canvas, 0, sampled(48, field));
            upload_table_2d(canvas, 1, lut);
            return [=, &canvas](int frame) {
              // The texture fills the world's box from 0.1 to 0.9.
              const float first = frame < 10 ? 0.1F : frame < 20 ? 0.3F : 0.5F;
              const float edge = frame < 10 ? 0.8F : 0.4F;
              std::vector<Vector> corners = box_triangles();
              for (Vector& corner : corners) corner = Vector{first, first, first} + edge * corner;
              const Camera camera = camera_at({.azimuth = 25, .elevation = 20, .degrees_each_frame = 2}, frame);
              canvas.begin(0.1F, 0.1F, 0.1F);
              program.use();
              program.set("density", 0);
              program.set("lut", 1);
              program.set("worldToClip", camera.clip_from_object());
              program.set("camera", camera.eye);
              program.set("low", Vector{first, first, first});
              program.set("high", Vector{first + edge, first + edge, first + edge});
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              box.draw(corners);
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
