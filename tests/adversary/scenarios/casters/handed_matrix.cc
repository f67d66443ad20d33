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

Scenario handed_matrix() {
  return {
      .sentence =
          "A chrysalis of 60 x 46 x 54 bytes in GLSL 3.30, in a box of the world that is longer than high. The "
          "vertex shader hands on the place in the world and, flat, the matrix from there to the texture, a "
          "uniform of its own that has no part in gl_Position. At frame 12 that matrix moves the volume by a "
          "quarter of the box; the box stays where it is.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 corner;

uniform mat4 viewProjection;
uniform mat4 worldToTexture;
uniform vec3 boxLow;
uniform vec3 boxHigh;

out vec3 world;
flat out mat4 textureFromWorld;

void main()
{
    world = mix(boxLow, boxHigh, corner);
    textureFromWorld = worldToTexture;
    gl_Position = viewProjection * vec4(world, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D chrysalis;
uniform sampler2D palette;
uniform vec3 viewer;
uniform vec3 boxLow;
uniform vec3 boxHigh;
uniform float spacing;

in vec3 world;
flat in mat4 textureFromWorld;
layout(location = 0) out vec4 outColour;

void main()
{
    vec3 ray = normalize(world - viewer);
    vec3 walls = (mix(boxLow, boxHigh, step(0.0, ray)) - world) / ray;
    int count = int(min(walls.x, min(walls.y, walls.z)) / spacing) + 1;

    vec4 sum = vec4(0.0);
    for (int i = 0; i < count; ++i)
    {
        vec4 here = vec4(world + float(i) * spacing * ray, 1.0);
        float value = texture(chrysalis, (textureFromWorld * here).xyz).r;
        vec4 colour = texture(palette, vec2(value, 0.5));
        sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
    }
    outColour = sum;
}
)");
        const VertexBuffer vertices(canvas);
        // Almost nothing at the faces, which the texture goes on with outside.
        const Field chrysalis = [](float x, float y, float z) {
          const float a = x - 0.48F, b = y - 0.5F, c = z - 0.52F;
          const float girth = 0.35F + 0.04F * std::sin(9 * x + 1) - 0.32F * a * a;
          const float away = std::sqrt(0.35F * a * a + b * b + c * c) + 0.02F * std::sin(7 * y + 5 * z);
          const float body = std::clamp(7 * (girth - away) + 0.5F, 0.0F, 1.0F) *
                             std::clamp(5.2F - 12 * std::abs(a), 0.0F, 1.0F);
          const float rings = 0.5F + 0.5F * std::sin(34 * x + 3 * std::cos(6 * y + 2) + 2 * std::sin(7 * z));
          const float wings = std::sin(12 * b + 4 * a) * std::cos(11 * c - 5 * a);
          return std::clamp(0.05F + body * (0.22F + 0.42F * rings + 0.2F * wings), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float chitin = std::clamp((at - 0.14F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(90 + 140 * chitin),
                           static_cast<std::uint8_t>(180 - 110 * std::sin(3 * at)),
                           static_cast<std::uint8_t>(70 + 90 * (1 - chitin) * (1 - chitin)),
                           static_cast<std::uint8_t>(std::lround(1 + 5 * at + 36 * chitin))});
        }
        upload_volume(canvas, 0, sampled(60, 46, 54, chrysalis));
        upload_table_2d(canvas, 1, table);

        const Vector low{-0.1F, 0.08F, -0.02F}, high{1.1F, 0.92F, 1.02F};
        program.use();
        program.set("chrysalis", 0);
        program.set("palette", 1);
        program.set("boxLow", low);
        program.set("boxHigh", high);
        program.set("spacing", 0.0175F);
        return [&canvas, program, vertices, low, high](int frame) {
          const Camera camera =
              camera_at({.azimuth = -30, .elevation = 22, .distance = 2.5F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector size = high - low;
          Matrix to_texture{1 / size.x, 0, 0, 0, 0, 1 / size.y, 0, 0, 0, 0, 1 / size.z, 0, 0, 0, 0, 1};
          to_texture[12] = -low.x / size.x - (frame < 12 ? 0 : 0.25F);
          to_texture[13] = -low.y / size.y;
          to_texture[14] = -low.z / size.z;
          canvas.begin(0.13F, 0.14F, 0.1F);
          program.use();
          program.set("viewProjection", camera.clip_from_object());
          program.set("worldToTexture", to_texture);
          program.set("viewer", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
