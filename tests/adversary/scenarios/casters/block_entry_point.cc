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

Scenario block_entry_point() {
  return {.sentence =
              "A geode of 48 x 40 x 56 bytes in GLSL 3.30, composed front to back through a 1-D table until "
              "0.98: a block of other instance names in both stages has the place in view space, which no "
              "fragment reads, the entry point, and the eye, found in every vertex by inverting the matrix.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 modelView;
uniform mat4 projection;

out RayVaryings {
	vec3 viewPosition;
	vec3 entryPoint;
	vec3 eye;
} toFragment;

void main()
{
	vec4 viewed = modelView * vec4(position, 1.0);
	toFragment.viewPosition = viewed.xyz;
	toFragment.entryPoint = position;
	toFragment.eye = (inverse(modelView) * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
	gl_Position = projection * viewed;
}
)",
                                      R"(#version 330 core
uniform sampler3D volumeTexture;
uniform sampler1D transferFunction;
uniform float stepSize;

in RayVaryings {
	vec3 viewPosition;
	vec3 entryPoint;
	vec3 eye;
} fromVertex;

out vec4 fragColor;

float distanceToExit(vec3 from, vec3 along)
{
	vec3 low = -from / along;
	vec3 high = (vec3(1.0) - from) / along;
	vec3 last = max(low, high);
	return min(last.x, min(last.y, last.z));
}

void main()
{
	vec3 along = normalize(fromVertex.entryPoint - fromVertex.eye);
	int steps = int(distanceToExit(fromVertex.entryPoint, along) / stepSize) + 1;
	vec3 advance = along * stepSize;
	vec3 current = fromVertex.entryPoint;

	vec4 composed = vec4(0.0);
	for (int n = 0; n < steps; n++) {
		float intensity = texture(volumeTexture, current).r;
		vec4 classified = texture(transferFunction, intensity);
		classified.rgb *= classified.a;
		composed += (1.0 - composed.a) * classified;
		if (composed.a > 0.98)
			break;
		current += advance;
	}
	fragColor = composed;
}
)");
            const VertexBuffer vertices(canvas);
            const Field geode = [](float x, float y, float z) {
              const float a = x - 0.52F, b = y - 0.47F, c = z - 0.5F;
              const float radius =
                  std::sqrt(a * a + 1.3F * b * b + c * c) + 0.03F * std::sin(9 * x + 5 * z - 4 * y);
              const float agate = 0.5F + 0.5F * std::sin(38 * radius + 2 * std::sin(6 * a - 5 * c));
              const float hollow = 0.5F + 0.5F * std::tanh(14 * (radius - 0.2F));
              const float stone = 0.5F - 0.5F * std::tanh(16 * (radius - 0.44F));
              return std::clamp(
                  0.06F + stone * hollow * (0.3F + 0.55F * agate) + 0.04F * std::sin(12 * z + 7 * y), 0.0F,
                  1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float crystal = std::clamp((at - 0.55F) / 0.3F, 0.0F, 1.0F);
              const float crust = std::exp(-std::pow((at - 0.35F) / 0.12F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(190 - 60 * at + 40 * crystal),
                               static_cast<std::uint8_t>(120 - 50 * crystal + 60 * at * at),
                               static_cast<std::uint8_t>(70 + 170 * crystal),
                               static_cast<std::uint8_t>(std::lround(10 * crust + 34 * crystal))});
            }
            upload_volume(canvas, 0, sampled(48, 40, 56, geode));
            upload_table_1d(canvas, 1, table);
            program.use();
            program.set("volumeTexture", 0);
            program.set("transferFunction", 1);
            program.set("stepSize", 0.0135F);
            return [&canvas, program, vertices](int frame) {
              const Camera camera =
                  camera_at({.azimuth = 120, .elevation = 34, .distance = 2.35F, .degrees_each_frame = 1.75F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.16F, 0.14F, 0.13F);
              program.use();
              program.set("modelView", camera.view);
              program.set("projection", camera.projection);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
