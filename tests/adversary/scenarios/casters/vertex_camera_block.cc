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

Scenario vertex_camera_block() {
  return {.sentence =
              "A jellyfish of 64 x 40 x 48 bytes in GLSL 4.50. Matrix, eye and the box's size lie in a uniform "
              "block of the vertex shader, rewritten in every frame; the vertex shader gives where rays enter "
              "and where they go, and the fragment shader marches without any uniform but its step. Nothing "
              "but the camera changes.",
          .expectation = Expectation::must_be_substituted,
          .most_compared = 2,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 corner;

layout(std140, binding = 0) uniform CameraBlock
{
	mat4 mvp;
	vec4 eye;
	vec4 size;
} camera;

layout(location = 0) out vec3 rayEntry;
layout(location = 1) out vec3 rayDirection;

void main()
{
	vec3 world = vec3(0.5) + (corner - vec3(0.5)) * camera.size.xyz;
	rayEntry = corner;
	rayDirection = (world - camera.eye.xyz) / camera.size.xyz;
	gl_Position = camera.mvp * vec4(world, 1.0);
}
)",
                                      R"(#version 450 core
layout(binding = 0) uniform sampler3D densities;
layout(binding = 1) uniform sampler2D transferFunction;
layout(location = 0) uniform float stepLength;

layout(location = 0) in vec3 rayEntry;
layout(location = 1) in vec3 rayDirection;
layout(location = 0) out vec4 fragment;

void main()
{
	const vec3 direction = normalize(rayDirection);
	const vec3 toWalls = (step(vec3(0.0), direction) - rayEntry) / direction;
	const float rayLength = min(toWalls.x, min(toWalls.y, toWalls.z));

	vec4 result = vec4(0.0);
	vec3 position = rayEntry;
	for (float travelled = 0.0; travelled < rayLength; travelled += stepLength)
	{
		const float density = texture(densities, position).r;
		const vec4 sampled = texture(transferFunction, vec2(density, 0.5));
		result.rgb += (1.0 - result.a) * sampled.a * sampled.rgb;
		result.a += (1.0 - result.a) * sampled.a;
		position += direction * stepLength;
	}
	fragment = result;
}
)");
            const VertexBuffer vertices(canvas);
            const Field jellyfish = [](float x, float y, float z) {
              const float a = x - 0.5F, c = z - 0.5F;
              const float away = std::sqrt(a * a + c * c), around = std::atan2(c, a);
              const float top = 0.86F - 1.7F * away * away;
              const float canopy =
                  std::exp(-130 * (y - top) * (y - top)) * std::clamp(5.5F - 12 * away, 0.0F, 1.0F);
              const float ring = away - 0.2F - 0.06F * std::sin(9 * y + 1);
              const float arms = std::exp(-110 * ring * ring) * (0.6F + 0.4F * std::cos(5 * around + 4 * y)) *
                                 std::clamp(3.4F - 5 * y, 0.0F, 1.0F);
              return std::clamp(
                  0.08F + 0.8F * canopy + 0.6F * arms + 0.05F * std::sin(11 * x + 6 * z) * std::cos(8 * y),
                  0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float skin = std::clamp((at - 0.18F) / 0.5F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(120 + 130 * skin),
                               static_cast<std::uint8_t>(190 - 100 * std::sin(3 * at)),
                               static_cast<std::uint8_t>(230 - 60 * at),
                               static_cast<std::uint8_t>(std::lround(2 + 6 * at + 34 * skin))});
            }
            upload_volume(canvas, 0, sampled(64, 40, 48, jellyfish));
            upload_table_2d(canvas, 1, table);
            struct CameraBlock {
              Matrix mvp;
              std::array<float, 4> eye, size;
            };
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, sizeof(CameraBlock), nullptr, GL_DYNAMIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, block);
            program.use();
            program.set("stepLength", 0.0175F);
            return [&canvas, program, vertices, block](int frame) {
              const Camera camera =
                  camera_at({.azimuth = 320, .elevation = -14, .distance = 2.4F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const CameraBlock numbers{.mvp = camera.clip_from_object(),
                                        .eye = {camera.eye.x, camera.eye.y, camera.eye.z, 1},
                                        .size = {1.1F, 0.9F, 1, 0}};
              canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
              canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(numbers), &numbers);
              canvas.begin(0.03F, 0.05F, 0.16F);
              program.use();
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
