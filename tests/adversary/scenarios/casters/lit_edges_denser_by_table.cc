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

Scenario lit_edges_denser_by_table() {
  return {
      .sentence =
          "A glacier in GLSL 1.40 under Lambert's light from the eye, whose table is looked up by value and, "
          "from row to row, by the length of the gradient: only steep edges are denser.",
      .expectation = Expectation::must_be_left,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 140

in vec3 position;

uniform mat4 toClip;
uniform vec3 viewer;

out vec3 fromViewer;

void main() {
    fromViewer = position - viewer;
    gl_Position = toClip * vec4(position, 1.0);
}
)",
                                  R"(#version 140

uniform sampler3D ice;
uniform sampler2D ramp;
uniform vec3 viewer;
uniform float spacing;

in vec3 fromViewer;
out vec4 result;

vec3 centralDifference(vec3 at) {
    vec3 e = 1.0 / vec3(textureSize(ice, 0));
    float x0 = texture(ice, vec3(at.x - e.x, at.y, at.z)).r;
    float x1 = texture(ice, vec3(at.x + e.x, at.y, at.z)).r;
    float y0 = texture(ice, vec3(at.x, at.y - e.y, at.z)).r;
    float y1 = texture(ice, vec3(at.x, at.y + e.y, at.z)).r;
    float z0 = texture(ice, vec3(at.x, at.y, at.z - e.z)).r;
    float z1 = texture(ice, vec3(at.x, at.y, at.z + e.z)).r;
    return 0.5 * vec3(x0 - x1, y0 - y1, z0 - z1);
}

void main() {
    vec3 ray = normalize(fromViewer);
    vec3 s = -viewer / ray;
    vec3 e = (1.0 - viewer) / ray;
    vec3 nearest = min(s, e);
    vec3 farthest = max(s, e);
    float tStart = max(max(max(nearest.x, nearest.y), nearest.z), 0.0);
    float tEnd = min(min(farthest.x, farthest.y), farthest.z);

    vec3 light = vec3(0.0);
    float transparency = 1.0;
    for (float t = tStart; t < tEnd; t += spacing) {
        vec3 at = viewer + t * ray;
        vec3 gradient = centralDifference(at);
        float slope = length(gradient);
        vec4 c = texture(ramp, vec2(texture(ice, at).r, min(20.0 * slope, 1.0)));
        vec3 n = slope > 0.0 ? gradient / slope : vec3(0.0);
        vec3 v = -ray;
        float shade = 0.3 + 0.7 * max(dot(n, v), 0.0);
        light += transparency * c.a * shade * c.rgb;
        transparency *= 1.0 - c.a;
    }
    result = vec4(light, 1.0 - transparency);
}
)");
        const VertexBuffer vertices(canvas);
        const Field glacier = [](float x, float y, float z) {
          const float surface = 0.62F - 0.3F * z + 0.08F * std::sin(7 * x + 4 * z) + 0.03F * std::sin(19 * z);
          const float crevasse = std::exp(-std::pow((x - 0.6F + 0.2F * z) / 0.12F, 2.0F));
          return std::clamp(0.45F + 1.3F * (surface - y) - 0.25F * crevasse * y, 0.0F, 1.0F);
        };
        constexpr int rows = 8;
        std::vector<Colour> table;
        for (int row = 0; row < rows; ++row) {
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float crust = std::exp(-std::pow((at - 0.5F) / 0.14F, 2.0F));
            const float dense = row < rows / 2 ? 0.5F : 1.2F;
            table.push_back({static_cast<std::uint8_t>(130 + 110 * crust),
                             static_cast<std::uint8_t>(170 + 70 * crust),
                             static_cast<std::uint8_t>(240 - 60 * at),
                             static_cast<std::uint8_t>(std::lround(dense * (38 * crust + 10 * at)))});
          }
        }
        upload_volume(canvas, 0, sampled(40, 32, 44, glacier), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table, rows);
        program.use();
        program.set("ice", 0);
        program.set("ramp", 1);
        program.set("spacing", 0.017F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 245, .elevation = 32, .distance = 2.4F, .degrees_each_frame = 1.1F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.12F, 0.1F, 0.18F);
          program.use();
          program.set("toClip", camera.clip_from_object());
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
