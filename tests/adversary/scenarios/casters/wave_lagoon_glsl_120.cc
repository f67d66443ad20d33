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

Scenario wave_lagoon_glsl_120() {
  return {
      .sentence =
          "A lagoon of 36 x 36 x 36 bytes in GLSL 1.20 with the matrices of fixed function: the ray is a "
          "varying "
          "without unit length, the eye a uniform, gradients over one and a half texels divided by "
          "sqrt(dot + 1e-5), light from the eye to the sixth power; the colour is not premultiplied when it "
          "leaves the shader, rays end at 0.95.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 120
attribute vec3 position;
uniform vec3 eye;
varying vec3 ray;

void main()
{
	ray = position - eye;
	gl_Position = gl_ModelViewProjectionMatrix * vec4(position, 1.0);
}
)",
                                  R"(#version 120
#define MAX_STEPS 200

uniform sampler3D volumeTex;
uniform sampler2D tfTex;
uniform vec3 eye;
uniform float texelSize;
uniform float stepSize;
varying vec3 ray;

float density(vec3 p)
{
	return texture3D(volumeTex, p).r;
}

float shade(vec3 p, vec3 v, out float gloss)
{
	float h = 1.5 * texelSize;
	vec3 g = vec3(
		density(p + vec3(h, 0.0, 0.0)) - density(p - vec3(h, 0.0, 0.0)),
		density(p + vec3(0.0, h, 0.0)) - density(p - vec3(0.0, h, 0.0)),
		density(p + vec3(0.0, 0.0, h)) - density(p - vec3(0.0, 0.0, h)));
	g *= 1.0 / sqrt(dot(g, g) + 1.0e-5);
	float c = abs(dot(g, v));
	gloss = 0.2 * pow(c, 6.0);
	return 0.2 + 0.6 * c;
}

void main()
{
	vec3 dir = normalize(ray);
	vec3 inv = 1.0 / dir;
	vec3 a = (vec3(0.0) - eye) * inv;
	vec3 b = (vec3(1.0) - eye) * inv;
	vec3 lo = min(a, b);
	vec3 hi = max(a, b);
	float t = max(0.0, max(lo.x, max(lo.y, lo.z)));
	float tFar = min(hi.x, min(hi.y, hi.z));

	vec3 rgb = vec3(0.0);
	float alpha = 0.0;
	for (int i = 0; i < MAX_STEPS; i++)
	{
		if (t > tFar || alpha > 0.95)
			break;
		vec3 p = eye + dir * t;
		vec4 c = texture2D(tfTex, vec2(density(p), 0.5));
		float gloss;
		float light = shade(p, -dir, gloss);
		float weight = (1.0 - alpha) * c.a;
		rgb += weight * (c.rgb * light + vec3(gloss));
		alpha += weight;
		t += stepSize;
	}
	if (alpha > 0.0)
		rgb /= alpha;
	gl_FragColor = vec4(rgb, alpha);
}
)");
        const VertexBuffer vertices(canvas);
        const Field lagoon = [](float x, float y, float z) {
          const float a = x - 0.48F, b = y - 0.35F, c = z - 0.52F;
          const float reef = std::sqrt(a * a + c * c) - 0.3F + 0.04F * std::sin(12 * x + 9 * z);
          return std::clamp(0.7F * std::exp(-18 * (reef * reef + 0.6F * b * b)) + 0.25F * y +
                                0.05F * std::sin(14 * y + 6 * z),
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float water = std::exp(-std::pow((at - 0.2F) / 0.1F, 2.0F));
          const float reef = std::clamp((at - 0.35F) / 0.3F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(40 + 180 * reef),
                           static_cast<std::uint8_t>(180 - 40 * reef),
                           static_cast<std::uint8_t>(200 - 130 * reef),
                           static_cast<std::uint8_t>(std::lround(8 * water + 52 * reef))});
        }
        upload_volume(canvas, 0, sampled(36, lagoon));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("volumeTex", 0);
        program.set("tfTex", 1);
        program.set("texelSize", 1 / 36.0F);
        program.set("stepSize", 0.02F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 15, .elevation = 42, .distance = 2.4F, .degrees_each_frame = 1.8F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.12F, 0.14F, 0.1F);
          canvas.gl.MatrixMode(GL_PROJECTION);
          canvas.gl.LoadMatrixf(camera.projection.data());
          canvas.gl.MatrixMode(GL_MODELVIEW);
          canvas.gl.LoadMatrixf(camera.view.data());
          program.use();
          program.set("eye", camera.eye);
          set_blending(canvas.gl, Blending::over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
