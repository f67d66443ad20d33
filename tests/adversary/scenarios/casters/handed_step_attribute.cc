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

Scenario handed_step_attribute() {
  return {
      .sentence =
          "A hailstone of 54 x 54 x 50 in 16 bits in GLSL 4.10. The length of steps is a vertex attribute "
          "without an array, set by glVertexAttrib1f, which the vertex shader hands on flat; opacities are as "
          "the table has them. It is halved at frame 9, and the stone becomes denser.",
      .expectation = Expectation::either,
      .key_frames = {9},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 a_place;
layout(location = 1) in float a_step;
uniform mat4 u_matrix;

layout(location = 0) out vec3 v_place;
layout(location = 1) flat out float v_step;

void main() {
	v_place = a_place;
	v_step = a_step;
	gl_Position = u_matrix * vec4(a_place, 1.0);
}
)",
                                  R"(#version 410 core
uniform sampler3D u_stone;
uniform sampler2D u_lut;
uniform vec3 u_eye;

layout(location = 0) in vec3 v_place;
layout(location = 1) flat in float v_step;
layout(location = 0) out vec4 f_colour;

void main() {
	vec3 ray = normalize(v_place - u_eye);
	vec3 ends = (step(0.0, ray) - v_place) / ray;
	float end = min(ends.x, min(ends.y, ends.z));

	vec4 front = vec4(0.0);
	for (float t = 0.0; t < end; t += v_step) {
		vec4 entry = texture(u_lut, vec2(texture(u_stone, v_place + t * ray).r, 0.5));
		front.rgb += (1.0 - front.a) * entry.a * entry.rgb;
		front.a += (1.0 - front.a) * entry.a;
	}
	f_colour = front;
}
)");
        const VertexBuffer vertices(canvas);
        const Field hailstone = [](float x, float y, float z) {
          const float a = x - 0.49F, b = y - 0.5F, c = z - 0.52F;
          const float away = std::sqrt(a * a + 1.2F * b * b + c * c) +
                             0.035F * std::sin(9 * x + 4 * y) * std::cos(8 * z - 5 * x + 1);
          const float layers = 0.5F + 0.5F * std::sin(30 * away + 1.5F * std::sin(6 * x - 4 * z));
          const float bubbles = std::sin(13 * x + 1) * std::sin(14 * y + 2) * std::sin(12 * z);
          const float body = std::clamp(5.8F - 13 * away, 0.0F, 1.0F);
          return std::clamp(0.06F + body * (0.25F + 0.45F * layers + 0.2F * bubbles) +
                                0.03F * std::sin(8 * z + 6 * y - 3 * x),
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float ice = std::clamp((at - 0.18F) / 0.55F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(70 + 160 * ice),
                           static_cast<std::uint8_t>(140 + 90 * std::sin(2.7F * at)),
                           static_cast<std::uint8_t>(240 - 100 * ice * ice),
                           static_cast<std::uint8_t>(std::lround(1 + 3 * at + 20 * ice))});
        }
        upload_volume(canvas, 0, sampled(54, 54, 50, hailstone), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, table);
        // Gl lacks this one.
        const auto set_attribute =
            reinterpret_cast<decltype(&::glVertexAttrib1f)>(eglGetProcAddress("glVertexAttrib1f"));
        set_attribute(1, 0.032F);
        program.use();
        program.set("u_stone", 0);
        program.set("u_lut", 1);
        return [&canvas, program, vertices, set_attribute](int frame) {
          if (frame == 9) set_attribute(1, 0.016F);
          const Camera camera =
              camera_at({.azimuth = 205, .elevation = 26, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.14F, 0.09F, 0.07F);
          program.use();
          program.set("u_matrix", camera.clip_from_object());
          program.set("u_eye", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
