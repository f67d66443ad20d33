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

Scenario wave_gallery_dims_slightly() {
  return {
      .sentence =
          "Pillars of 44 x 44 x 36 bytes in GLSL 4.40, lit from the eye by a lantern that loses about 7 % over "
          "the box; the eye is a flat vec4 in the coordinates of a scaled box, and the opacity at which rays "
          "end "
          "is "
          "a uniform that goes from 0.95 to 0.6 at frame 14.",
      .expectation = Expectation::either,
      .key_frames = {14},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 440 core
layout(location = 0) in vec3 position;

uniform mat4 mat_clip;
uniform vec4 eye_world;
uniform vec4 extent;  // of the box, in the world; w is unused

out VertexData {
    vec3 direction;
    flat vec4 eye;
} vertex_out;

void main()
{
    vec3 corner = vec3(0.5) - 0.5 * extent.xyz;
    vertex_out.eye = vec4((eye_world.xyz - corner) / extent.xyz, eye_world.w);
    vertex_out.direction = position - vertex_out.eye.xyz;
    gl_Position = mat_clip * vec4(corner + position * extent.xyz, 1.0);
}
)",
                                  R"(#version 440 core
layout(binding = 0) uniform sampler3D tex_volume;
layout(binding = 1) uniform sampler2D tex_lut;
uniform float step_length;
uniform float termination;

in VertexData {
    vec3 direction;
    flat vec4 eye;
} vertex_in;

layout(location = 0) out vec4 color;

float illumination(vec3 p, vec3 towards_eye, float distance_to_eye)
{
    vec3 h = 1.0 / textureSize(tex_volume, 0);
    vec3 g;
    g.x = texture(tex_volume, p + vec3(h.x, 0.0, 0.0)).r - texture(tex_volume, p - vec3(h.x, 0.0, 0.0)).r;
    g.y = texture(tex_volume, p + vec3(0.0, h.y, 0.0)).r - texture(tex_volume, p - vec3(0.0, h.y, 0.0)).r;
    g.z = texture(tex_volume, p + vec3(0.0, 0.0, h.z)).r - texture(tex_volume, p - vec3(0.0, 0.0, h.z)).r;
    float lambert = abs(dot(g, towards_eye)) / max(length(g), 1e-4);
    return (0.35 + 0.6 * lambert) / (1.0 + 0.011 * distance_to_eye * distance_to_eye);
}

void main()
{
    vec3 d = normalize(vertex_in.direction);
    d = mix(d, vec3(1e-6), lessThan(abs(d), vec3(1e-6)));
    vec3 o = vertex_in.eye.xyz;
    vec3 s = step(vec3(0.0), d);
    vec3 t_in = ((1.0 - s) - o) / d;
    vec3 t_out = (s - o) / d;
    float t = max(max(t_in.x, t_in.y), max(t_in.z, 0.0));
    float t_end = min(t_out.x, min(t_out.y, t_out.z));

    color = vec4(0.0);
    do {
        vec3 p = o + t * d;
        vec4 c = texture(tex_lut, vec2(texture(tex_volume, p).r, 0.5));
        c.rgb *= illumination(p, -d, t);
        color.rgb += (1.0 - color.a) * c.a * c.rgb;
        color.a += (1.0 - color.a) * c.a;
        t += step_length;
    } while (t < t_end && color.a < termination);
}
)");
        const VertexBuffer vertices(canvas);
        const Field pillars = [](float x, float y, float z) {
          const float across = std::sin(10 * x + 0.6F) * std::sin(9 * z + 1.2F);
          return std::clamp(
              0.45F + 0.4F * across * (0.8F + 0.2F * std::cos(8 * y)) + 0.12F * std::sin(11 * y - 3 * x), 0.0F,
              1.0F);
        };
        std::vector<Colour> lut;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float stone = std::clamp((at - 0.3F) / 0.5F, 0.0F, 1.0F);
          lut.push_back({static_cast<std::uint8_t>(240 - 60 * at), static_cast<std::uint8_t>(220 - 110 * at),
                         static_cast<std::uint8_t>(150 + 60 * std::sin(6 * at)),
                         static_cast<std::uint8_t>(std::lround(3 + 36 * stone))});
        }
        upload_volume(canvas, 0, sampled(44, 44, 36, pillars));
        upload_table_2d(canvas, 1, lut);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 290, .elevation = 18, .distance = 2.4F, .degrees_each_frame = 1.5F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.45F, 0.5F, 0.55F);
          program.use();
          program.set("mat_clip", camera.clip_from_object());
          canvas.gl.Uniform4f(program.location("eye_world"), camera.eye.x, camera.eye.y, camera.eye.z, 1);
          canvas.gl.Uniform4f(program.location("extent"), 1, 1.1F, 0.85F, 0);
          program.set("step_length", 0.02F);
          program.set("termination", frame < 14 ? 0.95F : 0.6F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
