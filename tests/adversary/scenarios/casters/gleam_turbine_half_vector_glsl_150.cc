// SPDX-License-Identifier: Apache-2.0
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

Scenario gleam_turbine_half_vector_glsl_150() {
  return {.sentence =
              "A turbine of 64 x 48 x 80 texels of 16 bits in GLSL 1.50: rays in the space of a box with edges "
              "of 0.8, "
              "0.6 and 1, differences at 1 / textureSize, ambient, diffuse and half-vector light, a 2-D table.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 150 core
in vec3 position;
uniform mat4 uModelViewProjection;
uniform vec3 uBoxExtent;
out vec3 vObjectPos;
void main()
{
  vObjectPos = (position - 0.5) * uBoxExtent;
  gl_Position = uModelViewProjection * vec4(vObjectPos, 1.0);
}
)",
                                      R"(#version 150 core
uniform sampler3D uData;
uniform sampler2D uLookup;
uniform vec3 uEye;
uniform vec3 uBoxExtent;
uniform float uStep;
in vec3 vObjectPos;
out vec4 fragColor;

struct Light { float ambient, diffuse, specular, shininess; };
const Light headlight = Light(0.18, 0.62, 0.35, 32.0);

float densityAt(vec3 p)
{
  return texture(uData, p / uBoxExtent + 0.5).r;
}

vec3 normalAt(vec3 p)
{
  vec3 h = uBoxExtent / vec3(textureSize(uData, 0));
  vec3 hi = vec3(densityAt(p + vec3(h.x, 0.0, 0.0)), densityAt(p + vec3(0.0, h.y, 0.0)),
                 densityAt(p + vec3(0.0, 0.0, h.z)));
  vec3 lo = vec3(densityAt(p - vec3(h.x, 0.0, 0.0)), densityAt(p - vec3(0.0, h.y, 0.0)),
                 densityAt(p - vec3(0.0, 0.0, h.z)));
  vec3 g = (lo - hi) / (2.0 * h);
  return g / max(length(g), 1e-4);
}

float exitDistance(vec3 origin, vec3 dir)
{
  vec3 t = max((-0.5 * uBoxExtent - origin) / dir, (0.5 * uBoxExtent - origin) / dir);
  return min(t.x, min(t.y, t.z));
}

void main()
{
  vec3 dir = normalize(vObjectPos - uEye);
  float tEnd = exitDistance(vObjectPos, dir);
  vec3 accumulated = vec3(0.0);
  float opacity = 0.0;
  for (int i = 0; float(i) * uStep <= tEnd; ++i) {
    vec3 p = vObjectPos + dir * (float(i) * uStep);
    vec4 material = texture(uLookup, vec2(densityAt(p), 0.5));
    vec3 N = normalAt(p);
    vec3 L = normalize(uEye - p);
    vec3 V = -dir;
    vec3 H = normalize(L + V);
    float nDotL = max(dot(N, L), 0.0);
    float nDotH = max(dot(N, H), 0.0);
    vec3 lit = material.rgb * (headlight.ambient + headlight.diffuse * nDotL) +
               headlight.specular * pow(nDotH, headlight.shininess);
    float weight = (1.0 - opacity) * material.a;
    accumulated += weight * lit;
    opacity += weight;
  }
  fragColor = vec4(accumulated, opacity);
}
)");
            const VertexBuffer vertices(canvas);
            const Field turbine = [](float x, float y, float z) {
              const float r = std::hypot(x - 0.45F, y - 0.52F);
              const float around = std::atan2(y - 0.52F, x - 0.45F);
              return 0.5F + 0.24F * std::cos(21 * r - 4 * z) + 0.9F * r * r * std::sin(5 * around + 6 * z) / 5 +
                     0.12F * std::sin(13 * z + 3 * x);
            };
            std::vector<Colour> lookup;
            for (int i = 0; i < 256; ++i) {
              const double at = i / 255.0;
              lookup.push_back({static_cast<std::uint8_t>(90 + 150 * at * at),
                                static_cast<std::uint8_t>(120 + 100 * std::sin(5 * at)),
                                static_cast<std::uint8_t>(220 - 170 * at),
                                static_cast<std::uint8_t>(3 + 24 * at * at)});
            }
            upload_volume(canvas, 0, sampled(64, 48, 80, turbine), {.texel = Texel::unsigned16});
            upload_table_2d(canvas, 1, lookup);
            program.use();
            program.set("uData", 0);
            program.set("uLookup", 1);
            program.set("uStep", 0.0125F);
            program.set("uBoxExtent", Vector{0.8F, 0.6F, 1.0F});
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 62, .elevation = 24, .distance = 2.4F, .degrees_each_frame = 1.5F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              // The box's centre is the origin of its space, and that of the camera's orbit.
              constexpr Vector centre{0.5F, 0.5F, 0.5F};
              const Matrix model{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, centre.x, centre.y, centre.z, 1};
              canvas.begin(0.05F, 0.07F, 0.1F);
              program.use();
              program.set("uModelViewProjection", camera.clip_from_object() * model);
              program.set("uEye", camera.eye - centre);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
