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

Scenario wave_dunes_other_names() {
  return {
      .sentence =
          "Dunes of 48 x 32 x 48 numbers of 16 bits in GLSL 4.10: direction and eye (a flat vec4 whose w is "
          "the "
          "step) reach the fragment shader by locations 3 and 5 under other names; light from the eye, "
          "gradients over half a texel, normalised where they are not zero, the table edited at frame 15.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 410 core

layout (location = 0) in vec3 in_corner;

uniform mat4 mvp;
uniform vec3 camera;
uniform float stride;

layout (location = 3) out vec3 vs_away;
layout (location = 5) flat out vec4 vs_camera;

void main ()
{
  vs_away = in_corner - camera;
  vs_camera = vec4 (camera, stride);
  gl_Position = mvp * vec4 (in_corner, 1.0);
}
)",
                                  R"(#version 410 core

uniform sampler3D dunes;
uniform sampler2D sand;

layout (location = 3) in vec3 ray;
layout (location = 5) flat in vec4 origin_and_step;

layout (location = 0) out vec4 out_colour;

struct Ray {
  vec3 origin;
  vec3 direction;
};

void clip_to_cube (const Ray r, out float enter, out float leave)
{
  vec3 a = -r.origin / r.direction;
  vec3 b = (1.0 - r.origin) / r.direction;
  vec3 first = min (a, b);
  vec3 last = max (a, b);
  enter = max (0.0, max (first.x, max (first.y, first.z)));
  leave = min (last.x, min (last.y, last.z));
}

vec3 surface_normal (vec3 where)
{
  vec3 half_texel = 0.5 / vec3 (textureSize (dunes, 0));
  float dx = texture (dunes, where + vec3 (half_texel.x, 0, 0)).r
           - texture (dunes, where - vec3 (half_texel.x, 0, 0)).r;
  float dy = texture (dunes, where + vec3 (0, half_texel.y, 0)).r
           - texture (dunes, where - vec3 (0, half_texel.y, 0)).r;
  float dz = texture (dunes, where + vec3 (0, 0, half_texel.z)).r
           - texture (dunes, where - vec3 (0, 0, half_texel.z)).r;
  vec3 slope = vec3 (dx, dy, dz) / (2.0 * half_texel);
  float steepness = length (slope);
  if (steepness > 0.0)
    return -slope / steepness;
  return vec3 (0.0);
}

void main ()
{
  Ray r = Ray (origin_and_step.xyz, normalize (ray));
  float enter, leave;
  clip_to_cube (r, enter, leave);
  int samples = int (ceil (max (leave - enter, 0.0) / origin_and_step.w));

  vec4 acc = vec4 (0.0);
  for (int s = 0; s < samples && acc.a < 0.95; ++s)
  {
    vec3 where = r.origin + (enter + (float (s) + 0.5) * origin_and_step.w) * r.direction;
    vec4 grain = texture (sand, vec2 (texture (dunes, where).r, 0.5));
    vec3 n = surface_normal (where);
    vec3 to_eye = normalize (r.origin - where);
    vec3 to_light = to_eye;
    vec3 halfway = normalize (to_light + to_eye);
    float diffuse = max (dot (n, to_light), 0.0);
    float specular = pow (max (dot (n, halfway), 0.0), 32.0);
    grain.rgb = grain.rgb * (0.2 + 0.7 * diffuse) + vec3 (0.3, 0.28, 0.2) * specular;
    acc += (1.0 - acc.a) * vec4 (grain.rgb * grain.a, grain.a);
  }
  out_colour = acc;
}
)");
        const VertexBuffer vertices(canvas);
        const Field dunes = [](float x, float y, float z) {
          const float crest = 0.45F + 0.12F * std::sin(11 * x + 3 * z) + 0.08F * std::sin(5 * z - 4 * x + 1);
          const float ripple = 0.03F * std::sin(30 * x - 9 * z);
          return std::clamp(0.5F + 1.1F * (crest + ripple - y), 0.0F, 1.0F);
        };
        const auto sand_of = [](bool night) {
          std::vector<Colour> sand;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float layer = std::exp(-std::pow((at - 0.55F) / 0.14F, 2.0F));
            const auto warm = static_cast<std::uint8_t>(210 - 60 * at);
            const auto mild = static_cast<std::uint8_t>(130 + 40 * at);
            const auto cold = static_cast<std::uint8_t>(50 + 90 * at * at);
            sand.push_back({night ? cold : warm, mild, night ? warm : cold,
                            static_cast<std::uint8_t>(std::lround((night ? 30 : 44) * layer + 12 * at))});
          }
          return sand;
        };
        upload_volume(canvas, 0, sampled(48, 32, 48, dunes), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, sand_of(false));
        program.use();
        program.set("dunes", 0);
        program.set("sand", 1);
        program.set("stride", 0.02F);
        return [&canvas, program, vertices, sand_of](int frame) {
          if (frame == 15) {
            const auto sand = sand_of(true);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, sand.data());
          }
          const Orbit orbit{.azimuth = 320, .elevation = 40, .distance = 2.2F, .degrees_each_frame = 1};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.3F, 0.25F, 0.2F);
          program.use();
          program.set("mvp", camera.clip_from_object());
          program.set("camera", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
