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

Scenario after_opaque_black_exposed() {
  return {
      .sentence =
          "Embers of 40 x 48 x 44 16-bit texels in GLSL 4.50, blending off, over black: the composed colour "
          "times an exposure is written with an alpha of 1, over a window cleared to black. The exposure is "
          "1 until frame 9, 3 from frame 10 on (much of the image is beyond white), and 0.5 from frame 20 on.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 position;
uniform mat4 modelViewProjection;
out VertexData { vec3 uvw; } vs_out;
void main()
{
	vs_out.uvw = position;
	gl_Position = modelViewProjection * vec4(position, 1.0);
}
)",
                                  R"(#version 450 core
in VertexData { vec3 uvw; } fs_in;
layout(location = 0) out vec4 target;
layout(binding = 0) uniform sampler3D embers;
layout(binding = 1) uniform sampler1D blackbody;
uniform vec3 cameraInVolume;
uniform float increment;
uniform float exposure;

void main()
{
	const vec3 direction = normalize(fs_in.uvw - cameraInVolume);
	vec3 p = fs_in.uvw;
	vec4 integrated = vec4(0.0);
	do
	{
		const vec4 s = texture(blackbody, texture(embers, p).r);
		integrated += (1.0 - integrated.a) * vec4(s.rgb * s.a, s.a);
		p += increment * direction;
	}
	while (all(greaterThanEqual(p, vec3(0.0))) && all(lessThanEqual(p, vec3(1.0))));
	target = vec4(exposure * integrated.rgb, 1.0);
}
)");
        const VertexBuffer vertices(canvas);
        const Field embers = [](float x, float y, float z) {
          const float coals = std::sin(13 * x + 2 * std::sin(9 * y)) * std::cos(12 * z + 3 * x) +
                              0.6F * std::sin(14 * y + 5 * z);
          return std::clamp(0.45F + 0.35F * coals - 0.3F * (y - 0.4F), 0.0F, 1.0F);
        };
        std::vector<Colour> blackbody;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const auto part = [at](float from, float to) {
            return static_cast<std::uint8_t>(
                std::lround(255 * std::clamp((at - from) / (to - from), 0.0F, 1.0F)));
          };
          blackbody.push_back({part(0.1F, 0.6F), part(0.4F, 0.9F), part(0.7F, 1.1F),
                               static_cast<std::uint8_t>(std::lround(2 + 36 * at * at))});
        }
        upload_volume(canvas, 0, sampled(40, 48, 44, embers), {.texel = Texel::unsigned16});
        upload_table_1d(canvas, 1, blackbody);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 285, .elevation = 37, .distance = 2.4F, .degrees_each_frame = -2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0, 0, 0);
          program.use();
          program.set("modelViewProjection", camera.clip_from_object());
          program.set("cameraInVolume", camera.eye);
          program.set("increment", 0.0165F);
          program.set("exposure", frame < 10 ? 1.0F : frame < 20 ? 3.0F : 0.5F);
          set_blending(canvas.gl, Blending::off);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
