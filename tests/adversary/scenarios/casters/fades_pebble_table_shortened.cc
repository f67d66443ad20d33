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

Scenario fades_pebble_table_shortened() {
  return {
      .sentence =
          "A pebble of 36 x 48 x 40 texels of 16 bits, soft on one side, GLSL 4.20, Lambert's light from "
          "the eye; the narrow peak of its gradient table, 1024 colours of floats, becomes another of 64 "
          "at frame 12, and the scale of gradients changes at frame 15.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {12, 15},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 pos;
uniform mat4 proj_view;
uniform vec3 eye_pos;
out vec3 vray_dir;
out vec3 vray_start;

void main(void) {
	gl_Position = proj_view * vec4(pos, 1);
	vray_start = pos;
	vray_dir = pos - eye_pos;
}
)",
                                  R"(#version 420 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D transfer_fcn;
layout(binding = 2) uniform sampler2D gradient_fcn;
uniform vec3 texel;
uniform float gradient_scale;
uniform float dt;

in vec3 vray_dir;
in vec3 vray_start;
out vec4 color;

vec3 gradient(vec3 p) {
	vec3 g;
	for (int axis = 0; axis < 3; ++axis) {
		vec3 offset = vec3(0);
		offset[axis] = texel[axis];
		g[axis] = (texture(volume, p + offset).r - texture(volume, p - offset).r) / (2.0 * texel[axis]);
	}
	return g;
}

void main(void) {
	vec3 ray_dir = normalize(vray_dir);
	vec3 t_ends = max(-vray_start / ray_dir, (1.0 - vray_start) / ray_dir);
	float t_end = min(t_ends.x, min(t_ends.y, t_ends.z));
	color = vec4(0.0);
	for (float t = 0.0; t < t_end; t += dt) {
		vec3 p = vray_start + t * ray_dir;
		float val = texture(volume, p).r;
		vec4 val_color = texture(transfer_fcn, vec2(val, 0.5));
		vec3 g = gradient(p);
		float g_len = length(g);
		val_color.a *= texture(gradient_fcn, vec2(min(gradient_scale * g_len, 1.0), 0.5)).r;
		vec3 n = g_len > 1e-6 ? g / g_len : vec3(0.0);
		val_color.rgb *= 0.35 + 0.65 * max(dot(n, ray_dir), 0.0);
		color.rgb += (1.0 - color.a) * val_color.a * val_color.rgb;
		color.a += (1.0 - color.a) * val_color.a;
	}
}
)");
        const VertexBuffer vertices(canvas);
        const Field pebble = [](float x, float y, float z) {
          const float u = x - 0.5F, v = 1.2F * (y - 0.5F), w = z - 0.5F;
          const float dents = 0.03F * std::sin(8 * x + 5 * y) * std::sin(7 * z);
          const float radius = std::sqrt(u * u + v * v + w * w) + dents;
          const float soft = 4 + 10 * x;
          const float speckle = 0.03F * std::sin(15 * y + 5 * z) * std::sin(12 * x);
          return std::clamp(0.5F + 0.42F * std::tanh(soft * (0.33F - radius)) + speckle, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float rind = std::clamp((at - 0.12F) / 0.15F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(70 + 170 * at), static_cast<std::uint8_t>(200 - 80 * at),
                           static_cast<std::uint8_t>(210 - 160 * at),
                           static_cast<std::uint8_t>(std::lround(70 * rind))});
        }
        // Red multiplies opacity; the others are not looked at.
        const auto peak_at = [](float centre, int entries) {
          std::vector<float> factors;
          for (int i = 0; i < entries; ++i) {
            const float at = static_cast<float>(i) / static_cast<float>(entries - 1);
            const float factor = std::max(0.0F, 1 - std::abs(at - centre) / 0.24F);
            factors.insert(factors.end(), {factor, 1 - factor, at, 1.0F});
          }
          return factors;
        };
        upload_volume(canvas, 0, sampled(36, 48, 40, pebble), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table);
        GLuint name = 0;
        canvas.gl.GenTextures(1, &name);
        canvas.gl.ActiveTexture(GL_TEXTURE2);
        canvas.gl.BindTexture(GL_TEXTURE_2D, name);
        filter_linearly(canvas, GL_TEXTURE_2D);
        canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 1024, 1, 0, GL_RGBA, GL_FLOAT,
                             peak_at(0.75F, 1024).data());
        return [&canvas, program, vertices, peak_at](int frame) {
          if (frame == 12) {
            const auto factors = peak_at(0.42F, 64);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 1, 0, GL_RGBA, GL_FLOAT, factors.data());
          }
          const Orbit orbit{.azimuth = 10, .elevation = 30, .distance = 2.2F, .degrees_each_frame = 2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.15F, 0.2F, 0.2F);
          program.use();
          program.set("proj_view", camera.clip_from_object());
          program.set("eye_pos", camera.eye);
          program.set("texel", Vector{1 / 36.0F, 1 / 48.0F, 1 / 40.0F});
          program.set("gradient_scale", frame < 15 ? 0.16F : 0.09F);
          program.set("dt", 0.016F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
