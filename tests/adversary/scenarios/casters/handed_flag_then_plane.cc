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

Scenario handed_flag_then_plane() {
  return {
      .sentence =
          "A cauliflower of 60 x 56 x 52 bytes in GLSL 4.30. A bool of the fragment shader says whether "
          "samples "
          "beyond a plane are left out; the plane is a uniform of the vertex shader, which hands on how far "
          "the vertex is from it and how that grows along the ray. The bool becomes true at frame 8, while "
          "the plane is outside of the box; from frame 11 on it slides in, in every frame.",
      .expectation = Expectation::either,
      .key_frames = {8, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 inVertex;

uniform mat4 mvp;
uniform vec3 eye;
uniform vec4 plane;

out vec3 surface;
out vec3 ray;
out float fromPlane;
out float growth;

void main()
{
    surface = inVertex;
    ray = inVertex - eye;
    fromPlane = dot(plane, vec4(inVertex, 1.0));
    growth = dot(plane.xyz, ray);
    gl_Position = mvp * vec4(inVertex, 1.0);
}
)",
                                  R"(#version 430 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D transfer;

uniform float stepSize;
uniform bool clipping;

in vec3 surface;
in vec3 ray;
in float fromPlane;
in float growth;
layout(location = 0) out vec4 fragment;

void main()
{
    float far = length(ray);
    vec3 direction = ray / far;
    float approach = growth / far;
    vec3 walls = (step(0.0, direction) - surface) / direction;
    int count = int(min(walls.x, min(walls.y, walls.z)) / stepSize) + 1;

    vec4 sum = vec4(0.0);
    for (int i = 0; i < count; ++i)
    {
        float t = float(i) * stepSize;
        if (clipping && fromPlane + t * approach < 0.0)
            continue;
        vec4 colour = texture(transfer, vec2(texture(volume, surface + t * direction).r, 0.5));
        sum += (1.0 - sum.a) * vec4(colour.a * colour.rgb, colour.a);
    }
    fragment = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cauliflower = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.52F, c = z - 0.5F;
          const float florets = std::sin(13 * x + 1) * std::sin(12 * z + 2) + 0.7F * std::cos(14 * y - 5 * x) +
                                0.3F * std::sin(21 * x + 5) * std::cos(19 * z - 16 * y);
          const float away = std::sqrt(a * a + 1.2F * b * b + c * c) - 0.035F * florets;
          const float head = std::clamp(5.4F - 13 * away, 0.0F, 1.0F);
          const float stalks = std::exp(-30 * (a * a + c * c)) * std::clamp(2.4F - 4 * y, 0.0F, 1.0F);
          return std::clamp(
              0.06F + head * (0.4F + 0.2F * florets) + 0.45F * stalks + 0.03F * std::sin(7 * x - 8 * y + 6 * z),
              0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float curd = std::clamp((at - 0.16F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(110 + 135 * curd),
                           static_cast<std::uint8_t>(170 + 60 * std::sin(3 * at)),
                           static_cast<std::uint8_t>(60 + 130 * curd * curd),
                           static_cast<std::uint8_t>(std::lround(2 + 4 * at + 34 * curd))});
        }
        upload_volume(canvas, 0, sampled(60, 56, 52, cauliflower));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("stepSize", 0.0165F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 40, .elevation = 24, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          // The corner towards the eye has the distance -1.64, the opposite one 0.
          const float distance = frame < 11 ? -1.9F : -1.36F + 0.033F * static_cast<float>(frame - 11);
          canvas.begin(0.1F, 0.08F, 0.14F);
          program.use();
          program.set("mvp", camera.clip_from_object());
          program.set("eye", camera.eye);
          program.set("clipping", frame < 8 ? 0 : 1);
          canvas.gl.Uniform4f(program.location("plane"), -0.8F, -0.36F, -0.48F, -distance);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
