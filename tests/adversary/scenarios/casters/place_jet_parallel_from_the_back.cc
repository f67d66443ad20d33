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

Scenario place_jet_parallel_from_the_back() {
  return {
      .sentence =
          "A jet of 32 x 32 x 64 texels of 16 bits in GLSL 1.30 under a parallel projection, its box long by a "
          "matrix: steps of one length in the world begin half a step behind the front faces, counted first "
          "and "
          "composed by the loop from the last to the first.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 130
in vec3 position;
uniform mat4 ViewProjection;
uniform mat4 Model;
out vec3 worldPosition;
out vec3 texturePosition;
void main()
{
  vec4 world = Model * vec4(position, 1.0);
  worldPosition = world.xyz;
  texturePosition = position;
  gl_Position = ViewProjection * world;
}
)",
                                  R"(#version 130
uniform sampler3D Jet;
uniform sampler1D ColorTable;
uniform vec3 ViewDirection;  // of the world, of unit length
uniform vec3 BoxSize;        // of the world
uniform float SampleDistance;
in vec3 worldPosition;
in vec3 texturePosition;
out vec4 FragmentColor;

void main()
{
  vec3 direction = ViewDirection / BoxSize;
  vec3 toPlanes = mix(-texturePosition, 1.0 - texturePosition, step(0.0, direction)) / direction;
  float rayLength = min(min(toPlanes.x, toPlanes.y), toPlanes.z);
  int n = int(floor(rayLength / SampleDistance + 0.5));
  vec4 accumulated = vec4(0.0);
  for (int i = n - 1; i >= 0; --i)
  {
    float along = (float(i) + 0.5) * SampleDistance;
    vec4 s = texture(ColorTable, texture(Jet, texturePosition + along * direction).r);
    accumulated.rgb = s.a * s.rgb + (1.0 - s.a) * accumulated.rgb;
    accumulated.a = s.a + (1.0 - s.a) * accumulated.a;
  }
  FragmentColor = accumulated;
}
)");
        const VertexBuffer vertices(canvas);
        const Field jet = [](float x, float y, float z) {
          const float a = x - 0.5F - 0.1F * z * std::sin(14 * z), b = y - 0.5F - 0.1F * z * std::cos(12 * z);
          const float width = 0.08F + 0.25F * z;
          const float core = std::exp(-(a * a + b * b) / (width * width));
          const float eddies = 0.3F * z * std::sin(24 * x + 9 * z) * std::sin(20 * y - 13 * z);
          return std::clamp(core * (0.95F - 0.3F * z) + eddies * core, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(255 * std::sqrt(at)),
                           static_cast<std::uint8_t>(40 + 190 * at * at),
                           static_cast<std::uint8_t>(190 * (1 - at) + 30),
                           static_cast<std::uint8_t>(std::lround(1 + 42 * at * (1.4F - at)))});
        }
        upload_volume(canvas, 0, sampled(32, 32, 64, jet),
                      {.texel = Texel::unsigned16, .shown = Shown::luminance});
        upload_table_1d(canvas, 1, table);
        return [&canvas, program, vertices](int frame) {
          const Camera camera = camera_at(
              {.azimuth = 100, .elevation = 22, .degrees_each_frame = 2, .projection = Projection::parallel},
              frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector size{0.65F, 0.65F, 1.2F};
          const Matrix model{size.x,
                             0,
                             0,
                             0,
                             0,
                             size.y,
                             0,
                             0,
                             0,
                             0,
                             size.z,
                             0,
                             0.5F - size.x / 2,
                             0.5F - size.y / 2,
                             0.5F - size.z / 2,
                             1};
          canvas.begin(0.15F, 0.15F, 0.12F);
          program.use();
          program.set("Jet", 0);
          program.set("ColorTable", 1);
          program.set("ViewProjection", camera.clip_from_object());
          program.set("Model", model);
          program.set("ViewDirection", camera.forward);
          program.set("BoxSize", size);
          program.set("SampleDistance", 0.03F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
