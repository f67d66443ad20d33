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

Scenario ends_storm_by_transmittance() {
  return {
      .sentence =
          "A storm of 48 x 32 x 40 16-bit texels in a box of 1 x 0.7 x 0.85, GLSL 3.30, steps in the world's "
          "units: transmittance is multiplied by exp(-density * step) of each sample, and rays end where it "
          "is below 0.02.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
in vec3 position;
uniform mat4 viewProjection;
uniform vec3 boxMin;
uniform vec3 boxMax;
out vec3 worldPosition;

void main()
{
    worldPosition = mix(boxMin, boxMax, position);
    gl_Position = viewProjection * vec4(worldPosition, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D densityTexture;
uniform sampler2D palette;
uniform vec3 boxMin;
uniform vec3 boxMax;
uniform vec3 cameraPosition;
uniform float stepWorld;
uniform float densityScale;

in vec3 worldPosition;
out vec4 fragColor;

vec2 intersectBox(vec3 origin, vec3 dir)
{
    vec3 a = (boxMin - origin) / dir;
    vec3 b = (boxMax - origin) / dir;
    vec3 lo = min(a, b);
    vec3 hi = max(a, b);
    return vec2(max(max(lo.x, lo.y), lo.z), min(min(hi.x, hi.y), hi.z));
}

void main()
{
    vec3 dir = normalize(worldPosition - cameraPosition);
    vec2 span = intersectBox(cameraPosition, dir);
    span.x = max(span.x, 0.0);

    vec3 light = vec3(0.0);
    float transmittance = 1.0;
    for (float t = span.x; t < span.y; t += stepWorld)
    {
        vec3 p = (cameraPosition + t * dir - boxMin) / (boxMax - boxMin);
        vec4 entry = texture(palette, vec2(texture(densityTexture, p).r, 0.5));
        float kept = exp(-densityScale * entry.a * stepWorld);
        light += transmittance * (1.0 - kept) * entry.rgb;
        transmittance *= kept;
        if (transmittance < 0.02)
            break;
    }
    fragColor = vec4(light, 1.0 - transmittance);
}
)");
        const VertexBuffer vertices(canvas);
        const Field storm = [](float x, float y, float z) {
          const float a = x - 0.45F, b = z - 0.55F;
          const float radius = std::sqrt(a * a + b * b);
          const float arms = std::sin(3 * std::atan2(b, a) + 14 * radius + 3 * y);
          return std::clamp(0.35F + 0.3F * arms + 0.3F * std::cos(8 * y + 5 * x) * (1 - radius), 0.0F, 1.0F);
        };
        std::vector<Colour> palette;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float body = std::clamp((at - 0.2F) / 0.6F, 0.0F, 1.0F);
          palette.push_back({static_cast<std::uint8_t>(40 + 205 * at),
                             static_cast<std::uint8_t>(90 + 130 * std::sin(3 * at)),
                             static_cast<std::uint8_t>(220 - 120 * at),
                             static_cast<std::uint8_t>(std::lround(6 + 240 * body * body))});
        }
        upload_volume(canvas, 0, sampled(48, 32, 40, storm), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, palette);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 15, .elevation = 34, .distance = 2.2F, .degrees_each_frame = 2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.75F, 0.8F, 0.85F);
          program.use();
          program.set("densityTexture", 0);
          program.set("palette", 1);
          program.set("viewProjection", camera.clip_from_object());
          program.set("boxMin", Vector{0, 0.15F, 0.1F});
          program.set("boxMax", Vector{1, 0.85F, 0.95F});
          program.set("cameraPosition", camera.eye);
          program.set("stepWorld", 0.0125F);
          program.set("densityScale", 26.0F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
