// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario change_leaps_and_projections() {
  return {
      .sentence =
          "Floats from -40 to 260 under a 1-D table. The camera jumps to the other side at frames 6, 12 and "
          "18, and "
          "below the volume at 24; the projection is orthographic in frames 9 to 14 and 20 to 26 (the eye is a "
          "vec4 "
          "whose w is then 0).",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {6, 9, 12, 15, 18, 20, 24, 27},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 projection;
uniform mat4 modelview;
out vec3 v_pos;
void main()
{
	v_pos = position;
	gl_Position = projection * (modelview * vec4(position, 1.0));
}
)",
                                  R"(#version 330 core
uniform sampler3D s_values;
uniform sampler1D s_colors;
uniform vec4 u_eye;
uniform vec2 u_range;
uniform float u_step;
in vec3 v_pos;
layout(location = 0) out vec4 o_color;

void main()
{
	vec3 dir = normalize(v_pos * u_eye.w - u_eye.xyz);
	vec3 tb = (vec3(greaterThan(dir, vec3(0.0))) - v_pos) / dir;
	float t_end = min(min(tb.x, tb.y), tb.z);
	int n = int(t_end / u_step) + 1;
	vec3 color = vec3(0.0);
	float alpha = 0.0;
	vec3 p = v_pos;
	for (int i = 0; i < n; ++i)
	{
		float v = (texture(s_values, p).r - u_range.x) / (u_range.y - u_range.x);
		vec4 c = texture(s_colors, v);
		color += (1.0 - alpha) * c.a * c.rgb;
		alpha += (1.0 - alpha) * c.a;
		p += u_step * dir;
	}
	o_color = vec4(color, alpha);
}
)");
        const VertexBuffer vertices(canvas);
        const Field pressure = [](float x, float y, float z) {
          return 110 + 70 * std::sin(7 * x + 3 * z) * std::cos(6 * y - 2 * x) +
                 80 * std::sin(9 * z + 2 * y * y) - 60 * (x - 0.3F) * y;
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(std::lround(255 * std::clamp(2 * at - 0.5F, 0.0F, 1.0F))),
                           static_cast<std::uint8_t>(200 - 150 * std::fabs(2 * at - 1)),
                           static_cast<std::uint8_t>(std::lround(255 * std::clamp(1.5F - 2 * at, 0.0F, 1.0F))),
                           static_cast<std::uint8_t>(std::lround(3 + 55 * std::pow(2 * at - 1, 2.0F)))});
        }
        upload_volume(canvas, 0, sampled(36, 44, 60, pressure), {.texel = Texel::float32});
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("s_values", 0);
        program.set("s_colors", 1);
        program.set("u_step", 0.017F);
        canvas.gl.Uniform2f(program.location("u_range"), -40, 260);
        return [&canvas, program, vertices](int frame) {
          const bool parallel = (frame >= 9 && frame <= 14) || (frame >= 20 && frame <= 26);
          const bool behind = (frame >= 6 && frame < 12) || frame >= 18;
          const Camera camera =
              camera_at({.azimuth = behind ? 205.0F : 25.0F,
                         .elevation = frame < 24 ? 24.0F : -50.0F,
                         .projection = parallel ? Projection::parallel : Projection::perspective},
                        frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.3F, 0.32F, 0.3F);
          program.use();
          program.set("projection", camera.projection);
          program.set("modelview", camera.view);
          if (parallel)
            canvas.gl.Uniform4f(program.location("u_eye"), -camera.forward.x, -camera.forward.y,
                                -camera.forward.z, 0);
          else
            canvas.gl.Uniform4f(program.location("u_eye"), camera.eye.x, camera.eye.y, camera.eye.z, 1);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
