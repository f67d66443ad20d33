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

Scenario gleam_nebula_squared_cosine() {
  return {
      .sentence =
          "A nebula of 24 x 32 x 28 bytes in GLSL 4.50 with explicit locations: colours from a table of 64, "
          "opacity by exp() of the density, differences of one texel, both sides lit by the squared cosine, no "
          "ambient light.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 iPosition;
layout(location = 0) uniform mat4 uTransform;
layout(location = 0) out vec3 oTexcoord;
out gl_PerVertex { vec4 gl_Position; };
void main()
{
  oTexcoord = iPosition;
  gl_Position = uTransform * vec4(iPosition, 1.0);
}
)",
                                  R"(#version 450 core
layout(location = 0) in vec3 iTexcoord;
layout(location = 0) out vec4 oColor;
layout(location = 4) uniform vec3 uOrigin;
layout(location = 5) uniform float uExtinction;
layout(location = 6) uniform int uResolution;
layout(binding = 0) uniform sampler3D tDensity;
layout(binding = 1) uniform sampler2D tColormap;

const float kSqrt3 = 1.7320508;

float density(const vec3 uvw) { return textureLod(tDensity, uvw, 0.0).r; }

vec3 centralDifference(const vec3 uvw)
{
  const vec3 texel = 1.0 / vec3(textureSize(tDensity, 0));
  const vec3 plus = vec3(density(uvw + vec3(texel.x, 0, 0)),
                         density(uvw + vec3(0, texel.y, 0)),
                         density(uvw + vec3(0, 0, texel.z)));
  const vec3 minus = vec3(density(uvw - vec3(texel.x, 0, 0)),
                          density(uvw - vec3(0, texel.y, 0)),
                          density(uvw - vec3(0, 0, texel.z)));
  return (plus - minus) / (2.0 * texel);
}

bool isInside(const vec3 uvw)
{
  return all(greaterThanEqual(uvw, vec3(-1e-5))) && all(lessThanEqual(uvw, vec3(1.0 + 1e-5)));
}

void main()
{
  const vec3 omega = normalize(iTexcoord - uOrigin);
  const float ds = kSqrt3 / float(uResolution);
  float visible = 1.0;
  vec3 light = vec3(0.0);
  for (int i = 0; i < uResolution; ++i)
  {
    const vec3 uvw = fma(vec3(float(i) * ds), omega, iTexcoord);
    if (!isInside(uvw))
      break;
    const float rho = density(uvw);
    const float alpha = 1.0 - exp(-uExtinction * rho * rho * ds);
    const vec3 g = centralDifference(uvw);
    const float c = dot(g, omega);
    const float c2 = c * c / max(dot(g, g), 1e-8);
    const vec3 albedo = textureLod(tColormap, vec2(rho, 0.5), 0.0).rgb;
    light += visible * alpha * (0.8 * c2 * albedo + 0.25 * pow(c2, 9.0));
    visible *= 1.0 - alpha;
  }
  oColor = vec4(light, 1.0 - visible);
}
)");
        const VertexBuffer vertices(canvas);
        const Field nebula = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.45F, c = z - 0.55F;
          return 0.25F + 0.4F * std::exp(-5 * (a * a + b * b + c * c)) +
                 0.1F * std::sin(11 * x - 5 * y) * std::cos(8 * z + 3 * x) + 0.1F * std::sin(9 * y + 6 * z + 1);
        };
        std::vector<Colour> colormap;
        colormap.reserve(64);
        for (int i = 0; i < 64; ++i)
          colormap.push_back({static_cast<std::uint8_t>(255 - 2 * i),
                              static_cast<std::uint8_t>(90 + i * i / 28),
                              static_cast<std::uint8_t>(130 + 110 * std::sin(0.09 * i)), 255});
        upload_volume(canvas, 0, sampled(24, 32, 28, nebula));
        upload_table_2d(canvas, 1, colormap);
        program.use();
        program.set("uExtinction", 14.0F);
        program.set("uResolution", 110);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 155, .elevation = 5, .distance = 2.8F, .degrees_each_frame = 1.7F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.02F, 0.02F, 0.06F);
          program.use();
          program.set("uTransform", camera.clip_from_object());
          program.set("uOrigin", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
