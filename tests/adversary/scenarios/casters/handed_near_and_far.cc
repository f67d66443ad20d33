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

Scenario handed_near_and_far() {
  return {
      .sentence =
          "A row of hills. As vispy does it, the vertex shader hands on where each ray crosses the near and "
          "the far "
          "plane, from inverted matrices, and the back faces are drawn. The camera goes around at one height.",
      .expectation = Expectation::must_be_substituted,
      .most_compared = 2,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 corner;
uniform mat4 projection;
uniform mat4 view;
out vec3 place;
out vec4 nearPlace;
out vec4 farPlace;
void main() {
  vec4 inView = view * vec4(corner, 1.0);
  vec4 inClip = projection * inView;
  inClip.z = -inClip.w;
  nearPlace = inverse(view) * (inverse(projection) * inClip);
  inClip.z = inClip.w;
  farPlace = inverse(view) * (inverse(projection) * inClip);
  place = corner;
  gl_Position = projection * inView;
}
)",
                                  R"(#version 330 core
uniform sampler3D hills;
uniform sampler2D colours;
uniform float stepInTexels;
uniform vec3 texels;
in vec3 place;
in vec4 nearPlace;
in vec4 farPlace;
out vec4 fragment;
void main() {
  vec3 from = nearPlace.xyz / nearPlace.w;
  vec3 towards = normalize((farPlace.xyz / farPlace.w - from) * texels) / texels;
  vec3 toWalls = (step(vec3(0.0), -towards) - place) / -towards;
  float way = min(toWalls.x, min(toWalls.y, toWalls.z));
  int samples = int(way / stepInTexels + 0.5);
  vec3 at = place - towards * float(samples) * stepInTexels;
  vec4 result = vec4(0.0);
  for (int i = 0; i < samples; ++i) {
    vec4 colour = texture(colours, vec2(texture(hills, at).r, 0.5));
    result += (1.0 - result.a) * vec4(colour.rgb * colour.a, colour.a);
    at += towards * stepInTexels;
  }
  fragment = result;
}
)");
        const VertexBuffer vertices(canvas);
        const Field hills = [](float x, float y, float z) {
          const float height = 0.45F + 0.2F * std::sin(9 * x + 2 * z) + 0.1F * std::cos(11 * z);
          const float ground = 0.5F - 0.5F * std::tanh(14 * (y - height));
          return std::clamp(0.08F + 0.75F * ground + 0.1F * std::sin(13 * x + 7 * y) * std::cos(10 * z), 0.0F,
                            1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(90 + 140 * at), static_cast<std::uint8_t>(200 - 90 * at),
                           static_cast<std::uint8_t>(60 + 60 * std::sin(6 * at)),
                           static_cast<std::uint8_t>(std::lround(2 + 30 * at * at))});
        }
        upload_volume(canvas, 0, sampled(48, 40, 44, hills));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("hills", 0);
        program.set("colours", 1);
        program.set("stepInTexels", 0.8F);
        program.set("texels", Vector{48, 40, 44});
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 40, .elevation = 20, .degrees_each_frame = 3}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.55F, 0.65F, 0.75F);
          program.use();
          program.set("projection", camera.projection);
          program.set("view", camera.view);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
