// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_rings_smoothstep() {
  return {.sentence =
              "Two rings of 32 x 32 x 32 bytes, light that falls off by smoothstep() of the angle, a box met "
              "from the eye, GLSL 4.20, a 2-D table that is replaced at frame 15, rays that end at 0.95.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 pos;
uniform mat4 proj_view;
uniform vec3 eye_pos;
uniform vec3 volume_scale;

out vec3 vray_dir;
flat out vec3 transformed_eye;

void main(void) {
	vec3 volume_translation = vec3(0.5) - volume_scale * 0.5;
	gl_Position = proj_view * vec4(pos * volume_scale + volume_translation, 1);
	transformed_eye = (eye_pos - volume_translation) / volume_scale;
	vray_dir = pos - transformed_eye;
}
)",
                                      R"(#version 420 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D transfer_fcn;
uniform float dt_scale;
uniform float gradient_step;

in vec3 vray_dir;
flat in vec3 transformed_eye;
out vec4 color;

vec2 intersect_box(vec3 orig, vec3 dir) {
	const vec3 box_min = vec3(0);
	const vec3 box_max = vec3(1);
	vec3 inv_dir = 1.0 / dir;
	vec3 tmin_tmp = (box_min - orig) * inv_dir;
	vec3 tmax_tmp = (box_max - orig) * inv_dir;
	vec3 tmin = min(tmin_tmp, tmax_tmp);
	vec3 tmax = max(tmin_tmp, tmax_tmp);
	float t0 = max(tmin.x, max(tmin.y, tmin.z));
	float t1 = min(tmax.x, min(tmax.y, tmax.z));
	return vec2(t0, t1);
}

float shade(vec3 p, vec3 ray_dir) {
	vec3 gx = vec3(gradient_step, 0, 0), gy = gx.yxz, gz = gx.yzx;
	vec3 n = -vec3(texture(volume, p + gx).r - texture(volume, p - gx).r,
		texture(volume, p + gy).r - texture(volume, p - gy).r,
		texture(volume, p + gz).r - texture(volume, p - gz).r);
	if (dot(n, n) > 0.0) {
		n = normalize(n);
	}
	return 0.25 + 0.75 * smoothstep(-0.2, 1.0, dot(n, -ray_dir));
}

void main(void) {
	vec3 ray_dir = normalize(vray_dir);
	vec2 t_hit = intersect_box(transformed_eye, ray_dir);
	if (t_hit.x > t_hit.y) {
		discard;
	}
	t_hit.x = max(t_hit.x, 0.0);
	float dt = dt_scale / 64.0;
	vec3 p = transformed_eye + t_hit.x * ray_dir;
	color = vec4(0.0);
	for (float t = t_hit.x; t < t_hit.y; t += dt) {
		float val = texture(volume, p).r;
		vec4 val_color = texture(transfer_fcn, vec2(val, 0.5));
		val_color.rgb *= shade(p, ray_dir);
		color.rgb += (1.0 - color.a) * val_color.a * val_color.rgb;
		color.a += (1.0 - color.a) * val_color.a;
		if (color.a >= 0.95) {
			break;
		}
		p += ray_dir * dt;
	}
}
)");
            const VertexBuffer vertices(canvas);
            const Field rings = [](float x, float y, float z) {
              const auto ring = [](float u, float v, float w, float radius) {
                const float across = std::sqrt(u * u + v * v) - radius;
                return 1 - std::sqrt(across * across + w * w) / 0.2F;
              };
              const float first = ring(x - 0.4F, y - 0.5F, z - 0.5F, 0.24F);
              const float second = ring(x - 0.64F, z - 0.5F, y - 0.48F, 0.22F);
              return std::clamp(std::max(first, second), 0.0F, 1.0F);
            };
            const auto table_of = [](int hue) {
              std::vector<Colour> table;
              for (int i = 0; i < 256; ++i) {
                const float at = static_cast<float>(i) / 255;
                const float skin = std::exp(-std::pow((at - 0.3F) / 0.09F, 2.0F));
                const float core = std::clamp((at - 0.55F) / 0.2F, 0.0F, 1.0F);
                const std::array<float, 3> levels{240 - 40 * at, 90 + 130 * core, 60 + 60 * at};
                const auto level = [&](int channel) {
                  return static_cast<std::uint8_t>(levels[static_cast<std::size_t>((channel + hue) % 3)]);
                };
                table.push_back({level(0), level(1), level(2),
                                 static_cast<std::uint8_t>(std::lround(30 * skin + 110 * core))});
              }
              return table;
            };
            upload_volume(canvas, 0, sampled(32, rings));
            upload_table_2d(canvas, 1, table_of(0));
            return [&canvas, program, vertices, table_of](int frame) {
              if (frame == 15) {
                const auto colours = table_of(2);
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                     colours.data());
              }
              const Orbit orbit{.azimuth = 25, .elevation = 35, .distance = 2.1F, .degrees_each_frame = 2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.15F, 0.2F, 0.2F);
              program.use();
              program.set("proj_view", camera.clip_from_object());
              program.set("eye_pos", camera.eye);
              program.set("volume_scale", Vector{1, 1, 1});
              program.set("dt_scale", 0.9F);
              program.set("gradient_step", 1 / 32.0F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
