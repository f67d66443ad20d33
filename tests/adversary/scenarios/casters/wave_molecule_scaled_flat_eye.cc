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

Scenario wave_molecule_scaled_flat_eye() {
  return {.sentence =
              "A molecule of 44 x 44 x 44 bytes in GLSL 4.20, drawn by the back faces of a box that a uniform "
              "makes "
              "longer and flatter; the eye goes to the fragments as a flat vec4; light from the eye in the "
              "volume's coordinates, normals divided by their length + 1e-3, rays end at an opacity from a "
              "uniform.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 420 core
layout(location=0) in vec3 pos;
uniform mat4 proj_view;
uniform vec3 eye_pos;
uniform vec3 volume_scale;

out vec3 vray_dir;
flat out vec4 transformed_eye;

void main(void) {
	// Translate the cube to center it at the origin of the orbit.
	vec3 volume_translation = vec3(0.5) - volume_scale * 0.5;
	gl_Position = proj_view * vec4(pos * volume_scale + volume_translation, 1);
	// Compute eye position and ray directions in the unit cube space
	transformed_eye = vec4((eye_pos - volume_translation) / volume_scale, 1);
	vray_dir = pos - transformed_eye.xyz;
}
)",
                                      R"(#version 420 core
layout(binding=0) uniform sampler3D volume;
layout(binding=1) uniform sampler2D transfer_fcn;
uniform float dt;
uniform float opacity_cutoff;

in vec3 vray_dir;
flat in vec4 transformed_eye;
out vec4 color;

vec2 intersect_box(vec3 orig, vec3 dir) {
	const vec3 box_min = vec3(0);
	const vec3 box_max = vec3(1);
	vec3 inv_dir = 1.0 / dir;
	vec3 tmin_tmp = (box_min - orig) * inv_dir;
	vec3 tmax_tmp = (box_max - orig) * inv_dir;
	vec3 tmin = min(tmin_tmp, tmax_tmp);
	vec3 tmax = max(tmin_tmp, tmax_tmp);
	return vec2(max(tmin.x, max(tmin.y, tmin.z)), min(tmax.x, min(tmax.y, tmax.z)));
}

vec3 gradient(vec3 p) {
	ivec3 dims = textureSize(volume, 0);
	vec3 h = vec3(1.0) / dims;
	vec3 lo, hi;
	for (int axis = 0; axis < 3; ++axis) {
		vec3 offset = vec3(0);
		offset[axis] = h[axis];
		lo[axis] = textureLod(volume, p - offset, 0).r;
		hi[axis] = textureLod(volume, p + offset, 0).r;
	}
	return hi - lo;
}

void main(void) {
	vec3 dir = normalize(vray_dir);
	vec2 t_hit = intersect_box(transformed_eye.xyz, dir);
	if (t_hit.x > t_hit.y) {
		discard;
	}
	t_hit.x = max(t_hit.x, 0.0);
	color = vec4(0);
	vec3 p = transformed_eye.xyz + t_hit.x * dir;
	for (float t = t_hit.x; t < t_hit.y; t += dt) {
		float val = textureLod(volume, p, 0).r;
		vec4 val_color = textureLod(transfer_fcn, vec2(val, 0.5), 0);
		vec3 g = gradient(p);
		vec3 n = g / (length(g) + 1e-3);
		float headlight = abs(dot(n, dir));
		val_color.rgb = val_color.rgb * (0.25 + 0.65 * headlight) + 0.2 * pow(headlight, 24.0);

		color.rgb += (1.0 - color.a) * val_color.a * val_color.rgb;
		color.a += (1.0 - color.a) * val_color.a;
		if (color.a >= opacity_cutoff) {
			break;
		}
		p += dir * dt;
	}
}
)");
            const VertexBuffer vertices(canvas);
            const Field molecule = [](float x, float y, float z) {
              static constexpr std::array<std::array<float, 4>, 6> atoms{{{0.35F, 0.4F, 0.5F, 0.24F},
                                                                          {0.6F, 0.45F, 0.42F, 0.21F},
                                                                          {0.72F, 0.68F, 0.55F, 0.16F},
                                                                          {0.22F, 0.62F, 0.66F, 0.15F},
                                                                          {0.45F, 0.25F, 0.72F, 0.17F},
                                                                          {0.5F, 0.72F, 0.28F, 0.15F}}};
              float sum = 0.04F + 0.03F * std::sin(9 * x + 4 * y - 6 * z);
              for (const auto& atom : atoms) {
                const float a = x - atom[0], b = y - atom[1], c = z - atom[2];
                sum += 0.62F * std::exp(-(a * a + b * b + c * c) / (atom[3] * atom[3]));
              }
              return std::clamp(sum, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float cloud = std::exp(-std::pow((at - 0.25F) / 0.1F, 2.0F));
              const float core = std::clamp((at - 0.5F) / 0.3F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(60 + 170 * core),
                               static_cast<std::uint8_t>(200 - 120 * core),
                               static_cast<std::uint8_t>(220 - 170 * core + 20 * at),
                               static_cast<std::uint8_t>(std::lround(22 * cloud + 95 * core))});
            }
            upload_volume(canvas, 0, sampled(44, molecule));
            upload_table_2d(canvas, 1, table);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 65, .elevation = 15, .distance = 2.2F, .degrees_each_frame = 2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.2F, 0.2F, 0.22F);
              program.use();
              program.set("proj_view", camera.clip_from_object());
              program.set("eye_pos", camera.eye);
              program.set("volume_scale", Vector{1.2F, 0.8F, 1.0F});
              program.set("dt", 0.0125F);
              program.set("opacity_cutoff", 0.92F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_FRONT);
              vertices.draw(box_triangles());
              canvas.gl.CullFace(GL_BACK);
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
