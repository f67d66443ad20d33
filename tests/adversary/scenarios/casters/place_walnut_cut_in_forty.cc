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

Scenario place_walnut_cut_in_forty() {
  return {
      .sentence =
          "A walnut of 40 x 52 x 44 texels of 16 bits in GLSL 1.50: every ray has 40 samples from where it "
          "enters "
          "the box of two uniforms to where it leaves, composed from the back; 20 in frames 9 to 14. From "
          "frame 20 "
          "on the box is cropped.",
      .expectation = Expectation::either,
      .key_frames = {9, 15, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 150
in vec3 position;
uniform mat4 mvp;
out vec3 surface;
void main()
{
    surface = position;
    gl_Position = mvp * vec4(position, 1.0);
}
)",
                                  R"(#version 150
uniform sampler3D scalars;
uniform sampler2D palette;
uniform vec3 origin;
uniform vec3 cropMin;
uniform vec3 cropMax;
uniform int sampleCount;
in vec3 surface;
out vec4 result;

void main()
{
    vec3 d = normalize(surface - origin);
    vec3 p = (cropMin - origin) / d;
    vec3 q = (cropMax - origin) / d;
    vec3 lo = min(p, q);
    vec3 hi = max(p, q);
    float enter = max(lo.x, max(lo.y, lo.z));
    float leave = min(hi.x, min(hi.y, hi.z));
    if (enter >= leave)
        discard;

    vec3 entry = origin + enter * d;
    vec3 stride = (leave - enter) * d / float(sampleCount);
    float thickness = length(stride) * 40.0;

    vec3 rgb = vec3(0.0);
    float transmitted = 1.0;
    for (int k = sampleCount - 1; k >= 0; --k)
    {
        vec3 here = entry + (float(k) + 0.5) * stride;
        vec4 c = texture(palette, vec2(texture(scalars, here).r, 0.5));
        float a = 1.0 - pow(1.0 - c.a, thickness);
        rgb = mix(rgb, c.rgb, a);
        transmitted *= 1.0 - a;
    }
    result = vec4(rgb, 1.0 - transmitted);
}
)");
        const VertexBuffer vertices(canvas);
        const Field walnut = [](float x, float y, float z) {
          const float a = x - 0.5F, b = (y - 0.5F) * 0.9F, c = z - 0.5F;
          const float r = std::sqrt(a * a + b * b + c * c);
          const float shell = std::exp(-std::pow((r - 0.4F) / 0.035F, 2.0F));
          const float folds = 0.5F + 0.5F * std::sin(26 * a + 6 * std::sin(9 * b)) * std::cos(18 * c + 7 * b);
          return std::clamp(0.9F * shell + (r < 0.34F ? 0.55F * folds : 0.04F), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(120 + 110 * at), static_cast<std::uint8_t>(200 - 120 * at),
                           static_cast<std::uint8_t>(40 + 130 * std::abs(std::sin(8 * at))),
                           static_cast<std::uint8_t>(std::lround(at < 0.1F ? 0.0F : 6 + 60 * at * at))});
        }
        upload_volume(canvas, 0, sampled(40, 52, 44, walnut), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 310, .elevation = 30, .distance = 2.4F, .degrees_each_frame = 2.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const bool dragged = frame >= 9 && frame < 15;
          canvas.begin(0.3F, 0.3F, 0.32F);
          program.use();
          program.set("scalars", 0);
          program.set("palette", 1);
          program.set("mvp", camera.clip_from_object());
          program.set("origin", camera.eye);
          program.set("cropMin", frame < 20 ? Vector{0, 0, 0} : Vector{0.1F, 0.0F, 0.25F});
          program.set("cropMax", frame < 20 ? Vector{1, 1, 1} : Vector{0.95F, 0.7F, 1});
          program.set("sampleCount", dragged ? 20 : 40);
          // The sum of colours that the opacities weighted already.
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
