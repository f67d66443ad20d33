// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario gleam_cells_rim_in_a_loop() {
  return {
      .sentence =
          "Cells of 36 x 36 x 36 half floats in GLSL 4.00: the ray from the vertex shader, a box of eight "
          "corners "
          "drawn by indices, gradient in a loop over the axes at a uniform distance, edges brighter than "
          "faces.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 vertex;
uniform mat4 mvp;
uniform vec3 viewpoint;
out VertexData {
  vec3 entry;
  vec3 ray;
} vs_out;
void main()
{
  vs_out.entry = vertex;
  vs_out.ray = vertex - viewpoint;
  gl_Position = mvp * vec4(vertex, 1.0);
}
)",
                                  R"(#version 400 core
in VertexData {
  vec3 entry;
  vec3 ray;
} fs_in;
layout(location = 0) out vec4 pixel;
uniform sampler3D cells;
uniform sampler2D stain;
uniform float probe;
uniform float stride;
uniform float base;
uniform float rim;

vec3 slope(in vec3 p)
{
  vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 e = vec3(0.0);
    e[axis] = probe;
    g[axis] = texture(cells, p + e).x - texture(cells, p - e).x;
  }
  return g;
}

void main()
{
  vec3 d = normalize(fs_in.ray);
  vec3 way = (step(vec3(0.0), d) - fs_in.entry) / d;
  int steps = int(floor(min(min(way.x, way.y), way.z) / stride));
  vec4 total = vec4(0.0);
  vec3 p = fs_in.entry;
  for (int s = 0; s <= steps; ++s, p += stride * d) {
    vec4 tissue = texture(stain, vec2(texture(cells, p).x, 0.5));
    vec3 g = slope(p);
    float facing = abs(dot(g, d)) / (length(g) + 1e-6);
    float brightness = base + rim * pow(1.0 - min(facing, 1.0), 2.0);
    total += (1.0 - total.a) * tissue.a * vec4(brightness * tissue.rgb, 1.0);
  }
  pixel = total;
}
)");
        const Field cells = [](float x, float y, float z) {
          return 0.5F + 0.33F * std::sin(10 * x + 0.5F) * std::sin(9 * y + 1.1F) * std::sin(11 * z + 0.4F) +
                 0.1F * std::cos(6 * (x + y) - 5 * z);
        };
        std::vector<Colour> stain;
        for (int i = 0; i < 256; ++i) {
          const double at = i / 255.0;
          const double membrane = std::exp(-90 * (at - 0.56) * (at - 0.56));
          stain.push_back({static_cast<std::uint8_t>(70 + 160 * membrane), static_cast<std::uint8_t>(200 * at),
                           static_cast<std::uint8_t>(210 - 90 * membrane),
                           static_cast<std::uint8_t>(4 + 20 * membrane + 8 * at)});
        }
        upload_volume(canvas, 0, sampled(36, cells), {.texel = Texel::half});
        upload_table_2d(canvas, 1, stain);
        const VertexBuffer vertices(canvas);
        std::array<Vector, 8> corners;
        for (int i = 0; i < 8; ++i)
          corners[i] = {static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2)};
        constexpr std::array<std::uint16_t, 36> indices{0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                        2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        vertices.fill(corners);
        GLuint elements = 0;
        canvas.gl.GenBuffers(1, &elements);
        canvas.gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements);
        canvas.gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof(indices), indices.data(), GL_STATIC_DRAW);
        program.use();
        program.set("cells", 0);
        program.set("stain", 1);
        program.set("probe", 1.0F / 36);
        program.set("stride", 0.02F);
        program.set("base", 0.3F);
        program.set("rim", 0.7F);
        return [&canvas, program](int frame) {
          const Camera camera =
              camera_at({.azimuth = 318, .elevation = 12, .distance = 2.55F, .degrees_each_frame = 2}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.0F, 0.0F, 0.0F);
          program.use();
          program.set("mvp", camera.clip_from_object());
          program.set("viewpoint", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          canvas.gl.DrawElements(GL_TRIANGLES, 36, GL_UNSIGNED_SHORT, nullptr);
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
