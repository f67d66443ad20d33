// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
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

Scenario packed_crop_integers() {
  return {
      .sentence =
          "Grapes of 52 x 48 x 60 bytes in GLSL 4.30. Two ivec3 crop the volume, in texels: samples before "
          "the one or from the other on are left out. Both are the volume's corners until high.z becomes 42 "
          "at frame 7, and 24 at frame 15.",
      .expectation = Expectation::either,
      .key_frames = {7, 15},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 inCorner;
uniform mat4 viewProjection;
out vec3 rayStart;

void main() {
    rayStart = inCorner;
    gl_Position = viewProjection * vec4(inCorner, 1.0);
}
)",
                                  R"(#version 430 core
layout(binding = 0) uniform sampler3D grapes;
layout(binding = 1) uniform sampler2D palette;
uniform vec3 viewer;
uniform float spacing;
uniform ivec3 low;
uniform ivec3 high;

in vec3 rayStart;
layout(location = 0) out vec4 outColour;

void main() {
    vec3 direction = normalize(rayStart - viewer);
    vec3 walls = (step(0.0, direction) - rayStart) / direction;
    float leave = min(walls.x, min(walls.y, walls.z));
    vec3 texels = vec3(textureSize(grapes, 0));

    vec4 sum = vec4(0.0);
    for (float t = 0.5 * spacing; t < leave; t += spacing) {
        vec3 here = rayStart + t * direction;
        ivec3 texel = ivec3(here * texels);
        if (any(lessThan(texel, low)) || any(greaterThanEqual(texel, high))) continue;
        vec4 colour = texture(palette, vec2(texture(grapes, here).r, 0.5));
        colour.rgb *= colour.a;
        sum += (1.0 - sum.a) * colour;
    }
    outColour = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field grapes = [](float x, float y, float z) {
          constexpr std::array<Vector, 10> berries{
              Vector{0.3F, 0.72F, 0.75F}, {0.65F, 0.75F, 0.7F}, {0.5F, 0.5F, 0.82F},  {0.24F, 0.36F, 0.6F},
              {0.76F, 0.42F, 0.62F},      {0.5F, 0.7F, 0.42F},  {0.3F, 0.55F, 0.28F}, {0.7F, 0.6F, 0.22F},
              {0.52F, 0.28F, 0.4F},       {0.45F, 0.24F, 0.74F}};
          float sum = 0.06F + 0.04F * std::sin(9 * x - 6 * y + 7 * z);
          for (const Vector berry : berries) {
            const Vector from = Vector{x, y, z} - berry;
            const float square = dot(from, from) + 0.004F * std::sin(13 * x + 11 * y) * std::cos(12 * z);
            sum += 0.85F * std::exp(-65 * square);
          }
          return std::clamp(sum, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float fruit = std::clamp((at - 0.2F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(210 - 120 * std::sin(3 * at)),
                           static_cast<std::uint8_t>(90 + 130 * (1 - fruit)),
                           static_cast<std::uint8_t>(80 + 150 * fruit),
                           static_cast<std::uint8_t>(std::lround(2 + 5 * at + 34 * fruit))});
        }
        constexpr int edge_x = 52, edge_y = 48, edge_z = 60;
        upload_volume(canvas, 0, sampled(edge_x, edge_y, edge_z, grapes));
        upload_table_2d(canvas, 1, table);
        // Gl lacks this one.
        const auto set_integers = reinterpret_cast<decltype(&::glUniform3i)>(eglGetProcAddress("glUniform3i"));
        program.use();
        program.set("spacing", 0.0165F);
        return [&canvas, program, vertices, set_integers](int frame) {
          const Camera camera =
              camera_at({.azimuth = -32, .elevation = 20, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.16F, 0.16F, 0.12F);
          program.use();
          program.set("viewProjection", camera.clip_from_object());
          program.set("viewer", camera.eye);
          set_integers(program.location("low"), 0, 0, 0);
          set_integers(program.location("high"), edge_x, edge_y, frame < 7 ? edge_z : frame < 15 ? 42 : 24);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
