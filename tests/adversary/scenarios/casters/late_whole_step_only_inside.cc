// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string vertex_120 = R"(#version 120
attribute vec3 position;
uniform mat4 clip_from_object;
varying vec3 entry;
void main()
{
	entry = position;
	gl_Position = clip_from_object * vec4(position, 1.0);
}
)";

const std::string advance_then_sample = R"(#version 120
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
varying vec3 entry;

void main()
{
	vec3 delta = step_length * normalize(entry - eye);
	vec3 p = entry;
	vec4 acc = vec4(0.0);
	for (int i = 0; i < 128; i++)
	{
		p += delta;
		if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0))))
			break;
		vec4 c = texture2D(table, vec2(texture3D(volume, p).r, 0.5));
		acc.rgb += (1.0 - acc.a) * c.a * c.rgb;
		acc.a += (1.0 - acc.a) * c.a;
	}
	gl_FragColor = acc;
}
)";

}  // namespace

Scenario late_whole_step_only_inside() {
  return {.sentence =
              "GLSL 1.20: the first sample is a whole step behind the entry, and samples are taken only in the "
              "box, so "
              "that short rays show nothing. Steps are 8 texels long, 20 in frames 10 to 18; opacities are not "
              "corrected.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 19},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float hump = std::exp(-std::pow((at - 0.6F) / 0.2F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(60 + 180 * at),
                               static_cast<std::uint8_t>(220 - 150 * hump),
                               static_cast<std::uint8_t>(240 - 200 * at),
                               static_cast<std::uint8_t>(std::lround(30 + 90 * hump))});
            }
            auto scene = caster_scene(canvas, {.fragment = advance_then_sample,
                                               .vertex = vertex_120,
                                               .grid = sampled(64, 56, 60, waves),
                                               .table = table,
                                               .orbit = {.azimuth = 300, .elevation = 15}});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("step_length", frame >= 10 && frame < 19 ? 0.33F : 0.13F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
