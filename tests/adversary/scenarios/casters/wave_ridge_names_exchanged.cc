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

Scenario wave_ridge_names_exchanged() {
  return {
      .sentence =
          "A ridge of 40 x 52 x 44 bytes in GLSL 4.50: the vertex shader's vFrom (on the box) and vTo (the "
          "eye) "
          "reach the fragment shader, by their locations, as its vTo and vFrom; light from the eye, gradients "
          "over two texels, inversesqrt(dot + 1e-6), rays end at 0.95.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 aPosition;

layout(location = 0) uniform mat4 uClipFromVolume;
layout(location = 1) uniform vec3 uEye;

// The light's way: from the box's surface to the eye.
layout(location = 0) smooth out vec3 vFrom;
layout(location = 1) flat out vec3 vTo;

void main()
{
  vFrom = aPosition;
  vTo = uEye;
  gl_Position = uClipFromVolume * vec4(aPosition, 1.0);
}
)",
                                  R"(#version 450 core
// The ray's way: from the eye to the box's surface.
layout(location = 1) flat in vec3 vFrom;
layout(location = 0) smooth in vec3 vTo;

layout(location = 0) out vec4 oColour;

layout(binding = 0) uniform sampler3D uVolume;
layout(binding = 1) uniform sampler2D uPalette;
layout(location = 8) uniform float uStep;

const int kMaximalSteps = 160;
const float kTolerance = 1e-5;

float fetch(in vec3 at) { return texture(uVolume, at).x; }

vec3 normalOf(in vec3 at)
{
  const vec2 span = vec2(2.0, 0.0);
  const vec3 texel = 1.0 / vec3(textureSize(uVolume, 0));
  const vec3 g = vec3(fetch(at + span.xyy * texel) - fetch(at - span.xyy * texel),
                      fetch(at + span.yxy * texel) - fetch(at - span.yxy * texel),
                      fetch(at + span.yyx * texel) - fetch(at - span.yyx * texel));
  return g * inversesqrt(dot(g, g) + 1e-6);
}

void main()
{
  const vec3 onward = normalize(vTo - vFrom);
  vec3 at = vTo;
  vec3 gathered = vec3(0.0);
  float transparency = 1.0;
  for (int n = 0; n < kMaximalSteps; ++n)
  {
    if (any(lessThan(at, vec3(-kTolerance))) || any(greaterThan(at, vec3(1.0 + kTolerance))))
      break;
    const vec4 entry = texture(uPalette, vec2(fetch(at), 0.5));
    const float facing = max(dot(normalOf(at), onward), 0.0);
    const vec3 shaded = entry.rgb * mix(0.35, 0.95, facing) + 0.25 * pow(facing, 20.0);
    gathered += transparency * entry.a * shaded;
    transparency *= 1.0 - entry.a;
    if (transparency < 0.05)
      break;
    at += uStep * onward;
  }
  oColour = vec4(gathered, 1.0 - transparency);
}
)");
        const VertexBuffer vertices(canvas);
        const Field ridge = [](float x, float y, float z) {
          const float line = y - 0.5F - 0.15F * std::sin(7 * x + 0.5F) + 0.1F * std::cos(9 * z + 2 * x);
          return std::clamp(0.9F * std::exp(-14 * line * line) + 0.1F * std::sin(10 * z - 6 * x) * y, 0.0F,
                            1.0F);
        };
        std::vector<Colour> palette;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          palette.push_back({static_cast<std::uint8_t>(230 * at),
                             static_cast<std::uint8_t>(120 + 70 * std::sin(5 * at)),
                             static_cast<std::uint8_t>(180 * (1 - at) + 20),
                             static_cast<std::uint8_t>(std::lround(6 + 50 * at * at))});
        }
        upload_volume(canvas, 0, sampled(40, 52, 44, ridge));
        upload_table_2d(canvas, 1, palette);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 200, .elevation = 28, .distance = 2.5F, .degrees_each_frame = 1.2F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.05F, 0.1F, 0.08F);
          program.use();
          program.set("uClipFromVolume", camera.clip_from_object());
          program.set("uEye", camera.eye);
          program.set("uStep", 0.02F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
