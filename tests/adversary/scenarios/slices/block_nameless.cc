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

namespace adversary::slices {

Scenario block_nameless() {
  return {.sentence =
              "Slices of a jellyfish across the view in GLSL 3.30: coordinate and tint go to the fragments in "
              "a block without an instance name. The tint, of a uniform of the vertex shader, is the same at "
              "all vertices, and is another one every fifth frame.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {5, 10, 15, 20, 25},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 u_modelViewProjection;
uniform vec4 u_tint;

out Varyings {
    vec3 coordinate;
    vec4 tint;
};

void main()
{
    coordinate = position;
    tint = u_tint;
    gl_Position = u_modelViewProjection * vec4(position, 1.0);
}
)",
                                      R"(#version 330 core
uniform sampler3D u_scan;
uniform sampler2D u_colours;

in Varyings {
    vec3 coordinate;
    vec4 tint;
};

out vec4 fragment;

void main()
{
    float scalar = texture(u_scan, coordinate).r;
    fragment = texture(u_colours, vec2(scalar, 0.5)) * tint;
}
)");
            const VertexBuffer vertices(canvas);
            const Field jellyfish = [](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.62F, c = z - 0.47F;
              const float around = std::atan2(c, a), away = std::sqrt(a * a + c * c);
              const float dome = std::sqrt(a * a + 1.8F * b * b + c * c) - 0.33F - 0.02F * std::sin(8 * around);
              const float umbrella = (0.5F + 0.5F * std::tanh(12 * (b + 0.12F))) * std::exp(-160 * dome * dome);
              const float ring = away - 0.2F - 0.06F * std::sin(11 * y + 2 * around);
              const float arms = (0.5F - 0.5F * std::tanh(9 * b)) * std::exp(-140 * ring * ring) *
                                 (0.6F + 0.4F * std::sin(6 * around + 5 * y));
              return std::clamp(0.1F + 0.8F * umbrella + 0.7F * arms + 0.06F * std::sin(9 * x + 6 * y - 8 * z),
                                0.0F, 1.0F);
            };
            std::vector<Colour> colours;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float flesh = std::clamp((at - 0.2F) / 0.5F, 0.0F, 1.0F);
              colours.push_back({static_cast<std::uint8_t>(110 + 140 * flesh),
                                 static_cast<std::uint8_t>(150 + 60 * std::sin(7 * at)),
                                 static_cast<std::uint8_t>(235 - 110 * flesh),
                                 static_cast<std::uint8_t>(std::lround(2 + 40 * flesh * (1.4F - flesh)))});
            }
            upload_volume(canvas, 0, sampled(52, 60, 46, jellyfish));
            upload_table_2d(canvas, 1, colours);
            program.use();
            program.set("u_scan", 0);
            program.set("u_colours", 1);
            return [&canvas, program, vertices](int frame) {
              constexpr std::array<std::array<float, 4>, 4> tints{
                  {{1, 1, 1, 1}, {1, 0.72F, 0.55F, 1}, {0.6F, 0.9F, 1, 0.8F}, {0.9F, 1, 0.5F, 1}}};
              const auto& [red, green, blue, alpha] = tints[static_cast<std::size_t>(frame) / 5 % tints.size()];
              const Camera camera =
                  camera_at({.azimuth = 200, .elevation = 12, .distance = 2.4F, .degrees_each_frame = 2}, frame,
                            static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.03F, 0.08F, 0.16F);
              program.use();
              program.set("u_modelViewProjection", camera.clip_from_object());
              canvas.gl.Uniform4f(program.location("u_tint"), red, green, blue, alpha);
              set_blending(canvas.gl, Blending::over);
              vertices.draw(triangles(view_aligned_slices(camera, 80)));
            };
          }};
}

}  // namespace adversary::slices
