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

Scenario packed_half_named() {
  return {
      .sentence =
          "A cumulus of 64 x 44 x 56 in 16 bits in GLSL 4.10. The block with the ray's entry, direction and "
          "end has an instance's name in the vertex shader, and none in the fragment shader. The loop ends "
          "at its `far`, of a uniform of the vertex shader, which is longer than any ray until frame 12, and "
          "short from then on.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 clipFromVolume;
uniform vec3 eye;
uniform float reach;

out Ray {
	vec3 entry;
	vec3 away;
	float far;
} toFragment;

void main()
{
	toFragment.entry = position;
	toFragment.away = position - eye;
	toFragment.far = reach;
	gl_Position = clipFromVolume * vec4(position, 1.0);
}
)",
                                  R"(#version 410 core
uniform sampler3D droplets;
uniform sampler1D tones;
uniform float spacing;

in Ray {
	vec3 entry;
	vec3 away;
	float far;
};

layout(location = 0) out vec4 fragment;

void main()
{
	vec3 direction = normalize(away);
	vec3 t1 = -entry / direction;
	vec3 t2 = (1.0 - entry) / direction;
	vec3 walls = max(t1, t2);
	float end = min(min(walls.x, walls.y), min(walls.z, far));

	vec3 position = entry;
	vec4 result = vec4(0.0);
	for (float t = 0.0; t < end; t += spacing) {
		vec4 tone = texture(tones, texture(droplets, position).r);
		result.rgb += (1.0 - result.a) * tone.a * tone.rgb;
		result.a += (1.0 - result.a) * tone.a;
		position += spacing * direction;
	}
	fragment = result;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cumulus = [](float x, float y, float z) {
          struct Puff {
            float x, y, z, size, weight;
          };
          constexpr std::array<Puff, 7> puffs{
              Puff{0.3F, 0.4F, 0.35F, 0.17F, 0.8F}, {0.55F, 0.55F, 0.5F, 0.2F, 0.75F},
              {0.72F, 0.38F, 0.7F, 0.16F, 0.85F},   {0.35F, 0.65F, 0.68F, 0.14F, 0.7F},
              {0.74F, 0.62F, 0.3F, 0.13F, 0.8F},    {0.5F, 0.3F, 0.2F, 0.12F, 0.6F},
              {0.22F, 0.3F, 0.75F, 0.13F, 0.75F}};
          float sum = 0.05F;
          for (const Puff& puff : puffs) {
            const float a = x - puff.x, b = y - puff.y, c = z - puff.z;
            sum += puff.weight * std::exp(-(a * a + b * b + c * c) / (puff.size * puff.size));
          }
          sum *= 0.85F + 0.15F * std::sin(15 * x + 3 * y) * std::cos(14 * z - 9 * y);
          return std::clamp(sum, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float water = std::clamp((at - 0.12F) / 0.7F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(250 - 130 * at),
                           static_cast<std::uint8_t>(200 + 50 * std::cos(4 * at)),
                           static_cast<std::uint8_t>(160 + 90 * at),
                           static_cast<std::uint8_t>(std::lround(1 + 3 * at + 22 * water))});
        }
        upload_volume(canvas, 0, sampled(64, 44, 56, cumulus), {.texel = Texel::unsigned16});
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("droplets", 0);
        program.set("tones", 1);
        program.set("spacing", 0.0175F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 60, .elevation = -22, .distance = 2.35F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.1F, 0.2F, 0.38F);
          program.use();
          program.set("clipFromVolume", camera.clip_from_object());
          program.set("eye", camera.eye);
          program.set("reach", frame < 12 ? 4.0F : 0.42F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
