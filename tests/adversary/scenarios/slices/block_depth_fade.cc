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

namespace adversary::slices {

Scenario block_depth_fade() {
  return {.sentence =
              "Slices of a reef of 16 bits across the axis nearest to the view in GLSL 4.20, premultiplied. A "
              "named block has a flat label, which row of the palette to take, then how clear the water is "
              "there, which grows with height and mixes the colour with the water's, and the coordinate last. "
              "Another label from frames 12 and 22 on.",
          .expectation = Expectation::either,
          .key_frames = {12, 22},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 in_position;
uniform mat4 clip_from_reef;
uniform int layer_label;

out SliceData {
  flat int label;
  smooth float clearness;
  smooth vec3 texcoord;
} vs_out;

void main() {
  vs_out.texcoord = in_position;
  vs_out.clearness = 0.1 + 0.9 * in_position.y;
  vs_out.label = layer_label;
  gl_Position = clip_from_reef * vec4(in_position, 1.0);
}
)",
                                      R"(#version 420 core
layout(binding = 0) uniform sampler3D soundings;
layout(binding = 1) uniform sampler2D palettes;
uniform vec3 water;

in SliceData {
  flat int label;
  smooth float clearness;
  smooth vec3 texcoord;
} fs_in;

layout(location = 0) out vec4 out_colour;

void main() {
  float echo = texture(soundings, fs_in.texcoord).r;
  float row = (float(fs_in.label) + 0.5) / float(textureSize(palettes, 0).y);
  vec4 rock = texture(palettes, vec2(echo, row));
  vec3 seen = mix(water, rock.rgb, fs_in.clearness);
  out_colour = vec4(seen * rock.a, rock.a);
}
)");
            const VertexBuffer vertices(canvas);
            const Field reef = [](float x, float y, float z) {
              const float ground =
                  0.38F + 0.12F * std::sin(7 * x + 2) * std::cos(6 * z - 1) + 0.1F * std::sin(5 * z);
              const float heads = 0.5F + 0.5F * std::sin(15 * x - 4 * z) * std::sin(13 * z + 3 * y);
              const float rock = 0.5F + 0.5F * std::tanh(7 * (ground + 0.3F * heads - y));
              return std::clamp(0.08F + 0.62F * rock + 0.22F * rock * std::sin(11 * y + 6 * x) +
                                    0.05F * std::sin(8 * x - 9 * y + 7 * z),
                                0.0F, 1.0F);
            };
            // A row each of 256 colours: rock, weed and sand.
            std::vector<Colour> palettes;
            for (int row = 0; row < 3; ++row)
              for (int i = 0; i < 256; ++i) {
                const float at = static_cast<float>(i) / 255;
                const float turn = 5 * at + 2.1F * static_cast<float>(row);
                const float dense = std::clamp((at - 0.15F) / 0.6F, 0.0F, 1.0F);
                palettes.push_back({static_cast<std::uint8_t>(140 + 100 * std::sin(turn)),
                                    static_cast<std::uint8_t>(140 + 90 * std::sin(turn + 2)),
                                    static_cast<std::uint8_t>(100 + 80 * std::cos(turn)),
                                    static_cast<std::uint8_t>(std::lround(1 + (18 + 8 * row) * dense))});
              }
            upload_volume(canvas, 0, sampled(60, 36, 48, reef), {.texel = Texel::unsigned16});
            upload_table_2d(canvas, 1, palettes, 3);
            return [&canvas, program, vertices](int frame) {
              // The nearest axis changes on the way.
              const Camera camera =
                  camera_at({.azimuth = 5, .elevation = 26, .distance = 2.4F, .degrees_each_frame = 2.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.75F, 0.85F, 0.88F);
              program.use();
              program.set("clip_from_reef", camera.clip_from_object());
              program.set("water", Vector{0.05F, 0.25F, 0.5F});
              program.set("layer_label", frame < 12 ? 0 : frame < 22 ? 1 : 2);
              set_blending(canvas.gl, Blending::premultiplied_over);
              vertices.draw(triangles(axis_aligned_slices(camera, 56)));
            };
          }};
}

}  // namespace adversary::slices
