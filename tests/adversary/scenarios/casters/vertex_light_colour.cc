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

Scenario vertex_light_colour() {
  return {
      .sentence =
          "A gourd of 56 x 48 x 56 in 16 bits in GLSL 4.00, lit by a light that stands in the world. Its place "
          "and its colour are uniforms of the vertex shader alone, which gives its direction and its colour as "
          "flat vec3. White becomes orange at frame 8; at frame 16 the light is moved to the other side.",
      .expectation = Expectation::either,
      .key_frames = {8, 16},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 corner;
uniform mat4 modelViewProjection;
uniform vec3 eye;
uniform vec3 lightPlace;
uniform vec3 colourOfLight;

out vec3 entry;
out vec3 view;
flat out vec3 towardsLamp;
flat out vec3 shine;

void main()
{
    entry = corner;
    view = corner - eye;
    towardsLamp = normalize(lightPlace - vec3(0.5));
    shine = colourOfLight;
    gl_Position = modelViewProjection * vec4(corner, 1.0);
}
)",
                                  R"(#version 400 core
uniform sampler3D gourd;
uniform sampler1D colours;
uniform float spacing;

in vec3 entry;
in vec3 view;
flat in vec3 towardsLamp;
flat in vec3 shine;
layout(location = 0) out vec4 pixel;

vec3 slope(vec3 p)
{
    vec3 h = 1.0 / vec3(textureSize(gourd, 0));
    return vec3(texture(gourd, p + vec3(h.x, 0.0, 0.0)).r - texture(gourd, p - vec3(h.x, 0.0, 0.0)).r,
                texture(gourd, p + vec3(0.0, h.y, 0.0)).r - texture(gourd, p - vec3(0.0, h.y, 0.0)).r,
                texture(gourd, p + vec3(0.0, 0.0, h.z)).r - texture(gourd, p - vec3(0.0, 0.0, h.z)).r);
}

void main()
{
    vec3 ray = normalize(view);
    vec3 exits = (step(vec3(0.0), ray) - entry) / ray;
    int samples = int(min(exits.x, min(exits.y, exits.z)) / spacing) + 1;
    vec3 gathered = vec3(0.0);
    float open = 1.0;
    for (int i = 0; i < samples; ++i) {
        vec3 p = entry + float(i) * spacing * ray;
        vec4 rind = texture(colours, texture(gourd, p).r);
        vec3 g = slope(p);
        vec3 normal = -g / max(length(g), 1e-3);
        vec3 light = vec3(0.25) + 0.85 * max(dot(normal, towardsLamp), 0.0) * shine;
        gathered += open * rind.a * rind.rgb * light;
        open *= 1.0 - rind.a;
    }
    pixel = vec4(gathered, 1.0 - open);
}
)");
        const VertexBuffer vertices(canvas);
        const Field gourd = [](float x, float y, float z) {
          const float a = x - 0.5F - 0.06F * std::sin(6 * y), b = z - 0.5F - 0.05F * std::cos(5 * y);
          const float away = std::sqrt(a * a + b * b);
          const float belly =
              std::exp(-12 * (y - 0.33F) * (y - 0.33F)) + 0.6F * std::exp(-30 * (y - 0.78F) * (y - 0.78F));
          const float ribs = 1 + 0.12F * std::cos(7 * std::atan2(b, a)) * std::clamp(6 * away, 0.0F, 1.0F);
          const float deep = 0.37F * belly * ribs - away;
          return 0.05F + 0.8F / (1 + std::exp(-22 * deep)) +
                 0.08F * std::sin(13 * x + 5 * z) * std::sin(11 * y);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float rind = std::exp(-std::pow((at - 0.45F) / 0.13F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(190 + 40 * at), static_cast<std::uint8_t>(215 - 60 * at),
                           static_cast<std::uint8_t>(140 + 90 * rind * at),
                           static_cast<std::uint8_t>(std::lround(46 * rind + 10 * at * at))});
        }
        upload_volume(canvas, 0, sampled(56, 48, 56, gourd), {.texel = Texel::unsigned16});
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("gourd", 0);
        program.set("colours", 1);
        program.set("spacing", 0.015F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 200, .elevation = 12, .distance = 2.3F, .degrees_each_frame = 1.25F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.1F, 0.1F, 0.14F);
          program.use();
          program.set("modelViewProjection", camera.clip_from_object());
          program.set("eye", camera.eye);
          program.set("lightPlace", frame < 16 ? Vector{1.5F, 2.5F, -2} : Vector{-3, 0.2F, -0.5F});
          program.set("colourOfLight", frame < 8 ? Vector{1, 1, 1} : Vector{1.1F, 0.6F, 0.2F});
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
