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

Scenario wave_coral_world_units() {
  return {
      .sentence =
          "Coral of 40 x 32 x 24 floats in GLSL 1.50, in a box of 1 x 0.8 x 0.6: directions, steps and normals "
          "are the world's, the eye is a vec3 uniform and is scaled for every fragment; both sides lit from "
          "the eye with a highlight of exponent 40, rays end at 0.95, a 1-D table edited at frame 16.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {16},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 150
in vec3 position;

uniform mat4 worldToClip;
uniform vec3 boxMin;
uniform vec3 boxSize;
uniform vec3 eyeWorld;

out vec3 toVertex;

void main()
{
    vec3 world = boxMin + position * boxSize;
    toVertex = world - eyeWorld;
    gl_Position = worldToClip * vec4(world, 1.0);
}
)",
                                  R"(#version 150
uniform sampler3D coral;
uniform sampler1D lut;
uniform vec3 boxMin;
uniform vec3 boxSize;
uniform vec3 eyeWorld;
uniform float worldStep;

in vec3 toVertex;
out vec4 pixel;

// In the world's units, so that a flat box does not bend the normals.
vec3 worldGradient(vec3 uvw)
{
    vec3 e = 1.0 / vec3(textureSize(coral, 0));
    vec3 g = vec3(
        texture(coral, vec3(uvw.x + e.x, uvw.yz)).r - texture(coral, vec3(uvw.x - e.x, uvw.yz)).r,
        texture(coral, vec3(uvw.x, uvw.y + e.y, uvw.z)).r - texture(coral, vec3(uvw.x, uvw.y - e.y, uvw.z)).r,
        texture(coral, vec3(uvw.xy, uvw.z + e.z)).r - texture(coral, vec3(uvw.xy, uvw.z - e.z)).r);
    return g / (2.0 * e * boxSize);
}

void main()
{
    vec3 rayWorld = normalize(toVertex);
    vec3 eye = (eyeWorld - boxMin) / boxSize;
    vec3 ray = rayWorld / boxSize;

    vec3 t0 = (vec3(0.0) - eye) / ray;
    vec3 t1 = (vec3(1.0) - eye) / ray;
    vec3 tMin = min(t0, t1);
    vec3 tMax = max(t0, t1);
    float t = max(max(tMin.x, tMin.y), max(tMin.z, 0.0));
    float tEnd = min(min(tMax.x, tMax.y), tMax.z);

    vec4 dst = vec4(0.0);
    while (t < tEnd && dst.a < 0.95)
    {
        vec3 uvw = eye + t * ray;
        vec4 src = texture(lut, texture(coral, uvw).r);
        if (src.a > 0.002)
        {
            vec3 n = worldGradient(uvw);
            float m = length(n);
            if (m > 0.0)
                n /= m;
            float d = abs(dot(n, rayWorld));
            src.rgb = src.rgb * (0.25 + 0.6 * d) + 0.3 * pow(d, 40.0);
            src.rgb *= src.a;
            dst += (1.0 - dst.a) * src;
        }
        t += worldStep;
    }
    pixel = dst;
}
)");
        const VertexBuffer vertices(canvas);
        const Field coral = [](float x, float y, float z) {
          const float a = std::sin(8 * x + 1) * std::cos(7 * y);
          const float b = std::sin(7 * y + 2) * std::cos(6 * z + 1);
          const float c = std::sin(6 * z) * std::cos(8 * x + 0.5F);
          return std::clamp(0.5F + 0.3F * (a + b + c) - 0.2F * (y - 0.5F), 0.0F, 1.0F);
        };
        const auto lut_of = [](bool bleached) {
          std::vector<Colour> lut;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float wall = std::clamp((at - 0.45F) / 0.25F, 0.0F, 1.0F);
            const auto level = [at](float low, float high) {
              return static_cast<std::uint8_t>(low + (high - low) * at);
            };
            lut.push_back({bleached ? level(230, 180) : level(250, 120),
                           bleached ? level(200, 230) : level(90, 60),
                           bleached ? level(140, 240) : level(70, 200),
                           static_cast<std::uint8_t>(std::lround(60 * wall * wall))});
          }
          return lut;
        };
        upload_volume(canvas, 0, sampled(40, 32, 24, coral), {.texel = Texel::float32});
        upload_table_1d(canvas, 1, lut_of(false));
        return [&canvas, program, vertices, lut_of](int frame) {
          if (frame == 16) {
            const auto colours = lut_of(true);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage1D(GL_TEXTURE_1D, 0, 0, 256, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          const Orbit orbit{.azimuth = 115, .elevation = 22, .distance = 2.1F, .degrees_each_frame = 1.6F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.02F, 0.08F, 0.15F);
          program.use();
          program.set("coral", 0);
          program.set("lut", 1);
          program.set("worldToClip", camera.clip_from_object());
          program.set("boxMin", Vector{0, 0.1F, 0.2F});
          program.set("boxSize", Vector{1, 0.8F, 0.6F});
          program.set("eyeWorld", camera.eye);
          program.set("worldStep", 0.015F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
