// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario gleam_torch_loses_strength() {
  return {
      .sentence =
          "Strata of 56 x 40 x 48 bytes in GLSL 1.30, Lambert's light from the eye and some ambient light; the "
          "light from the eye loses strength with the distance it goes, so far parts are a little darker.",
      .expectation = Expectation::either,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 130
in vec3 position;
uniform mat4 modelViewProjectionMatrix;
out vec3 texCoord;
void main()
{
  texCoord = position;
  gl_Position = modelViewProjectionMatrix * vec4(position, 1.0);
}
)",
                                  R"(#version 130
uniform sampler3D strata;
uniform sampler2D rocks;
uniform vec3 torch;
uniform float reach;
uniform float dt;
in vec3 texCoord;
out vec4 color;

vec3 getGradient(sampler3D tex, vec3 p)
{
  vec3 size = vec3(textureSize(tex, 0));
  vec3 d = 1.0 / size;
  float gx = texture(tex, p + vec3(d.x, 0.0, 0.0)).r - texture(tex, p - vec3(d.x, 0.0, 0.0)).r;
  float gy = texture(tex, p + vec3(0.0, d.y, 0.0)).r - texture(tex, p - vec3(0.0, d.y, 0.0)).r;
  float gz = texture(tex, p + vec3(0.0, 0.0, d.z)).r - texture(tex, p - vec3(0.0, 0.0, d.z)).r;
  return 0.5 * size * vec3(gx, gy, gz);
}

void main()
{
  vec3 dir = normalize(texCoord - torch);
  vec3 ends = (step(0.0, dir) - texCoord) / dir;
  int n = int(min(ends.x, min(ends.y, ends.z)) / dt) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < n; ++i) {
    vec3 p = texCoord + float(i) * dt * dir;
    vec4 rock = texture(rocks, vec2(texture(strata, p).r, 0.5));
    vec3 g = getGradient(strata, p);
    float lambert = max(dot(g, dir) / max(length(g), 1e-4), 0.0);
    vec3 away = p - torch;
    float strength = reach * reach / (reach * reach + dot(away, away));
    rock.rgb *= 0.25 + 0.9 * strength * lambert;
    sum += (1.0 - sum.a) * vec4(rock.rgb * rock.a, rock.a);
  }
  color = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field strata = [](float x, float y, float z) {
          return 0.5F + 0.28F * std::sin(14 * y + 2 * std::sin(5 * x + 1) + 1.5F * std::cos(6 * z)) +
                 0.13F * std::sin(9 * x - 7 * z);
        };
        upload_volume(canvas, 0, sampled(56, 40, 48, strata));
        upload_table_2d(canvas, 1, soft_colours());
        program.use();
        program.set("strata", 0);
        program.set("rocks", 1);
        program.set("reach", 4.0F);
        program.set("dt", 0.02F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 280, .elevation = 30, .distance = 2.4F, .degrees_each_frame = 1};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.1F, 0.08F, 0.06F);
          program.use();
          program.set("modelViewProjectionMatrix", camera.clip_from_object());
          program.set("torch", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
