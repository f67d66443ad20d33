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

Scenario count_floor_from_entry() {
  return {.sentence =
              "A stalactite of 36 x 28 x 44 luminances of 16 bits in GLSL 1.20 with the matrices of fixed "
              "function, whose inverse gives the eye, drawn by its back faces: as many samples as whole "
              "steps fit into the ray, the first at the entry.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 120
attribute vec3 position;
varying vec3 texCoord;
varying vec3 cameraPos;

void main()
{
	texCoord = position;
	cameraPos = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
	gl_Position = gl_ModelViewProjectionMatrix * vec4(position, 1.0);
}
)",
                                      R"(#version 120
uniform sampler3D volume;
uniform sampler1D lut;
uniform float stepLength;
varying vec3 texCoord;
varying vec3 cameraPos;

bool rayBox(in vec3 o, in vec3 d, out float t0, out float t1)
{
	vec3 bottom = (vec3(0.0) - o) / d;
	vec3 top = (vec3(1.0) - o) / d;
	vec3 smaller = min(bottom, top);
	vec3 larger = max(bottom, top);
	t0 = max(max(smaller.x, smaller.y), smaller.z);
	t1 = min(min(larger.x, larger.y), larger.z);
	return t1 > t0;
}

void main()
{
	vec3 d = normalize(texCoord - cameraPos);
	float t0, t1;
	if (!rayBox(cameraPos, d, t0, t1))
		discard;
	t0 = max(t0, 0.0);

	int steps = int((t1 - t0) / stepLength);
	vec3 entry = cameraPos + t0 * d;
	vec3 colour = vec3(0.0);
	float opacity = 0.0;
	for (int k = 0; k < steps; k++)
	{
		vec3 here = entry + float(k) * stepLength * d;
		vec4 c = texture1D(lut, texture3D(volume, here).x);
		float visible = (1.0 - opacity) * c.a;
		colour += visible * c.rgb;
		opacity += visible;
	}
	gl_FragColor = vec4(colour, opacity);
}
)");
            const VertexBuffer vertices(canvas);
            const Field stalactite = [](float x, float y, float z) {
              const float a = x - 0.46F - 0.08F * std::sin(4 * y), b = z - 0.55F;
              const float width = 0.12F + 0.28F * y + 0.02F * std::sin(24 * y + 3 * x);
              return std::clamp(0.55F + 1.8F * (width - std::sqrt(a * a + b * b)), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float rock = std::clamp((at - 0.15F) / 0.5F, 0.0F, 1.0F);
              const float smooth = rock * rock * (3 - 2 * rock);
              table.push_back({static_cast<std::uint8_t>(90 + 130 * smooth),
                               static_cast<std::uint8_t>(110 + 60 * smooth),
                               static_cast<std::uint8_t>(190 - 110 * smooth),
                               static_cast<std::uint8_t>(std::lround(2 + 38 * smooth * (1.3F - at)))});
            }
            upload_volume(canvas, 0, sampled(36, 28, 44, stalactite),
                          {.texel = Texel::unsigned16, .shown = Shown::luminance});
            upload_table_1d(canvas, 1, table);
            program.use();
            program.set("volume", 0);
            program.set("lut", 1);
            program.set("stepLength", 0.019F);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 200, .elevation = 17, .distance = 2.7F, .degrees_each_frame = 1.2F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.2F, 0.18F, 0.15F);
              canvas.gl.MatrixMode(GL_PROJECTION);
              canvas.gl.LoadMatrixf(camera.projection.data());
              canvas.gl.MatrixMode(GL_MODELVIEW);
              canvas.gl.LoadMatrixf(camera.view.data());
              program.use();
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_FRONT);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
