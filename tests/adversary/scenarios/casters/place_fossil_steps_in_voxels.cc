// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario place_fossil_steps_in_voxels() {
  return {.sentence =
              "A fossil of 64 x 32 x 40 luminance bytes in GLSL 1.20, immediate mode, its box turned and made "
              "flat by "
              "the model matrix: steps of 1.25 voxels, whatever their shape, the first sample half a step in.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 120
varying vec3 entryPoint;
varying vec3 viewer;
void main()
{
	entryPoint = gl_MultiTexCoord0.xyz;
	viewer = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
	gl_Position = ftransform();
}
)",
                                      R"(#version 120
uniform sampler3D tex;
uniform sampler1D lut;
uniform vec3 dims;
uniform float sampling;
varying vec3 entryPoint;
varying vec3 viewer;

void main()
{
	// one step is `sampling` voxels long
	vec3 voxelRay = normalize((entryPoint - viewer) * dims);
	vec3 delta = sampling * voxelRay / dims;
	vec3 p = entryPoint + 0.5 * delta;
	vec3 colour = vec3(0.0);
	float T = 1.0;
	for (int n = 0; n < 256; n++)
	{
		if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0))))
			break;
		vec4 s = texture1D(lut, texture3D(tex, p).x);
		colour += T * s.a * s.rgb;
		T *= 1.0 - s.a;
		p += delta;
	}
	gl_FragColor = vec4(colour, 1.0 - T);
}
)");
            const Field fossil = [](float x, float y, float z) {
              const float a = x - 0.48F, b = z - 0.52F;
              const float angle = std::atan2(b, a), r = std::sqrt(a * a + b * b);
              const float spiral = std::cos(26 * r - 2 * angle + 0.6F);
              const float ribs = 0.25F * std::sin(18 * angle + 12 * r) * r;
              const float flat = std::exp(-std::pow((y - 0.5F) / 0.28F, 2.0F));
              return std::clamp((0.5F + 0.42F * spiral + ribs) * flat + 0.06F * std::sin(30 * x + 11 * y), 0.0F,
                                1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float ridge = std::clamp((at - 0.35F) / 0.4F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(80 + 160 * ridge),
                               static_cast<std::uint8_t>(70 + 110 * at),
                               static_cast<std::uint8_t>(140 - 80 * ridge),
                               static_cast<std::uint8_t>(std::lround(1 + 70 * ridge * ridge))});
            }
            upload_volume(canvas, 0, sampled(64, 32, 40, fossil), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, table);
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(
                  canvas, frame, {.azimuth = 60, .elevation = 35, .distance = 2.4F, .degrees_each_frame = 2});
              begin_old_frame(canvas, camera);
              const float c = std::cos(0.6F), s = std::sin(0.6F);
              const Matrix to_middle{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5F, 0.5F, 0.5F, 1};
              const Matrix turn{c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
              const Matrix stretch{1.15F, 0, 0, 0, 0, 0.6F, 0, 0, 0, 0, 0.95F, 0, 0, 0, 0, 1};
              const Matrix from_middle{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.5F, -0.5F, 1};
              const Matrix model_view = camera.view * to_middle * turn * stretch * from_middle;
              canvas.gl.MatrixMode(GL_MODELVIEW);
              canvas.gl.LoadMatrixf(model_view.data());
              program.use();
              program.set("tex", 0);
              program.set("lut", 1);
              program.set("dims", Vector{64, 32, 40});
              program.set("sampling", 1.25F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              canvas.gl.Begin(GL_TRIANGLES);
              for (const Vector& corner : box_triangles()) {
                canvas.gl.TexCoord3f(corner.x, corner.y, corner.z);
                canvas.gl.Vertex3f(corner.x, corner.y, corner.z);
              }
              canvas.gl.End();
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
