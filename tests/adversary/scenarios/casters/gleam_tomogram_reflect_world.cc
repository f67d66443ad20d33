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

Scenario gleam_tomogram_reflect_world() {
  return {
      .sentence =
          "A tomogram of 72 x 60 x 60 texels, 12 of 16 bits used, in GLSL 4.20: rays in the world, where the "
          "box "
          "is from -1 to 1, opacity corrected for the step, one distance of differences for all axes, Phong's "
          "light by reflect(), a 1-D table.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 inPosition;
uniform mat4 clipFromWorld;
out vec3 worldPosition;
void main()
{
  worldPosition = inPosition;
  gl_Position = clipFromWorld * vec4(inPosition, 1.0);
}
)",
                                  R"(#version 420 core
layout(binding = 3) uniform sampler3D scan;
layout(binding = 4) uniform sampler1D transfer;
uniform vec3 cameraWorld;
uniform float sampleDistance;
uniform float gradientStep;
uniform float kAmbient;
uniform float kDiffuse;
uniform float kSpecular;
uniform float shininess;
in vec3 worldPosition;
layout(location = 0) out vec4 fragment;

const vec3 boxMin = vec3(-1.0);
const vec3 boxMax = vec3(1.0);

float scalar(vec3 world)
{
  vec3 tc = (world - boxMin) / (boxMax - boxMin);
  return texture(scan, tc).r * (65535.0 / 4095.0);
}

vec3 gradientWorld(vec3 w)
{
  vec3 dx = vec3(gradientStep, 0.0, 0.0);
  vec3 dy = dx.yxz;
  vec3 dz = dx.yzx;
  return vec3(scalar(w + dx) - scalar(w - dx),
              scalar(w + dy) - scalar(w - dy),
              scalar(w + dz) - scalar(w - dz)) / (2.0 * gradientStep);
}

vec4 classify(float s)
{
  vec4 c = texture(transfer, s);
  c.a = 1.0 - pow(1.0 - c.a, sampleDistance / 0.02);
  return c;
}

vec3 illuminate(vec3 color, vec3 g, vec3 view)
{
  float magnitude = length(g);
  if (magnitude < 1e-5)
    return kAmbient * color;
  vec3 n = -g / magnitude;
  vec3 light = view;
  float nl = max(dot(n, light), 0.0);
  vec3 r = reflect(-light, n);
  float rv = max(dot(r, view), 0.0);
  vec3 result = (kAmbient + kDiffuse * nl) * color;
  if (nl > 0.0)
    result += kSpecular * pow(rv, shininess);
  return result;
}

void main()
{
  vec3 rayDir = normalize(worldPosition - cameraWorld);
  vec3 tExit = (mix(boxMin, boxMax, greaterThan(rayDir, vec3(0.0))) - worldPosition) / rayDir;
  float tEnd = min(tExit.x, min(tExit.y, tExit.z));

  vec4 result = vec4(0.0);
  for (float t = 0.0; t < tEnd; t += sampleDistance)
  {
    vec3 w = worldPosition + rayDir * t;
    vec4 c = classify(scalar(w));
    c.rgb = illuminate(c.rgb, gradientWorld(w), -rayDir);
    result.rgb = result.rgb + (1.0 - result.a) * c.a * c.rgb;
    result.a = result.a + (1.0 - result.a) * c.a;
  }
  fragment = result;
}
)");
        const VertexBuffer vertices(canvas);
        const Field head = [](float x, float y, float z) {
          const float u = 2.1F * (x - 0.48F), v = 1.8F * (y - 0.52F), w = 2.3F * (z - 0.5F);
          const float d = std::sqrt(u * u + v * v + w * w + 0.01F);
          return (0.45F + 0.28F * std::cos(11 * d) / (0.8F + d) + 0.1F * std::sin(9 * x - 6 * z + 2) -
                  0.08F * y) *
                 4095 / 65535;
        };
        std::vector<Colour> transfer;
        for (int i = 0; i < 256; ++i) {
          const double at = i / 255.0;
          const double bone = at < 0.45 ? 0 : (at - 0.45) / 0.55;
          transfer.push_back({static_cast<std::uint8_t>(200 + 50 * bone),
                              static_cast<std::uint8_t>(95 + 150 * at),
                              static_cast<std::uint8_t>(70 + 140 * bone),
                              static_cast<std::uint8_t>(2 + 10 * at + 40 * bone * bone)});
        }
        upload_volume(canvas, 3, sampled(72, 60, 60, head), {.texel = Texel::unsigned16});
        upload_table_1d(canvas, 4, transfer);
        program.use();
        program.set("sampleDistance", 0.03F);
        program.set("gradientStep", 0.03F);
        program.set("kAmbient", 0.22F);
        program.set("kDiffuse", 0.68F);
        program.set("kSpecular", 0.25F);
        program.set("shininess", 16.0F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 15, .elevation = 40, .distance = 2.6F, .degrees_each_frame = 1.2F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          // The camera looks at [0,1]^3, and the world is [-1,1]^3.
          const Matrix halved{0.5F, 0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0.5F, 0, 0.5F, 0.5F, 0.5F, 1};
          std::vector<Vector> corners = box_triangles();
          for (Vector& corner : corners) corner = 2 * corner - Vector{1, 1, 1};
          canvas.begin(0.15F, 0.18F, 0.25F);
          program.use();
          program.set("clipFromWorld", camera.clip_from_object() * halved);
          program.set("cameraWorld", 2 * camera.eye - Vector{1, 1, 1});
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(corners);
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
