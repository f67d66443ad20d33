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

Scenario ends_roots_gradient_opacity() {
  return {.sentence =
              "Roots of 48 x 48 x 48 bytes in GLSL 4.50, not lit: opacity is multiplied by a table of the "
              "gradient's "
              "length; the loop goes on while alpha is not above 0.99.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) out vec3 start;
uniform mat4 modelViewProjection;

void main()
{
    start = position;
    gl_Position = modelViewProjection * vec4(position, 1.0);
}
)",
                                      R"(#version 450 core
layout(location = 0) in vec3 start;
layout(location = 0) out vec4 target;

layout(binding = 0) uniform sampler3D volumeData;
layout(binding = 1) uniform sampler1D colorTable;
layout(binding = 2) uniform sampler1D gradientOpacityTable;
uniform vec3 cameraInVolume;
uniform float stepLength;
uniform float gradientScale;

float gradientMagnitude(vec3 p)
{
    const vec3 d = 1.0 / vec3(textureSize(volumeData, 0));
    vec3 g;
    g.x = texture(volumeData, p + vec3(d.x, 0.0, 0.0)).r - texture(volumeData, p - vec3(d.x, 0.0, 0.0)).r;
    g.y = texture(volumeData, p + vec3(0.0, d.y, 0.0)).r - texture(volumeData, p - vec3(0.0, d.y, 0.0)).r;
    g.z = texture(volumeData, p + vec3(0.0, 0.0, d.z)).r - texture(volumeData, p - vec3(0.0, 0.0, d.z)).r;
    return length(g);
}

void main()
{
    vec3 dir = normalize(start - cameraInVolume);
    vec3 toPlanes = (vec3(greaterThan(dir, vec3(0.0))) - start) / dir;
    float remaining = min(toPlanes.x, min(toPlanes.y, toPlanes.z));
    vec3 p = start;
    vec4 result = vec4(0.0);

    while (remaining >= 0.0 && !(result.a > 0.99))
    {
        vec4 c = texture(colorTable, texture(volumeData, p).r);
        float alpha = c.a * texture(gradientOpacityTable, gradientScale * gradientMagnitude(p)).r;
        result.rgb += (1.0 - result.a) * alpha * c.rgb;
        result.a += (1.0 - result.a) * alpha;
        p += stepLength * dir;
        remaining -= stepLength;
    }
    target = result;
}
)");
            const VertexBuffer vertices(canvas);
            const Field roots = [](float x, float y, float z) {
              float value = 0.08F + 0.06F * std::sin(6 * x + 3 * y);
              for (int i = 0; i < 4; ++i) {
                const float phase = 1.7F * static_cast<float>(i);
                const float a = x - 0.5F - 0.28F * std::sin(4 * y + phase);
                const float b = z - 0.5F - 0.28F * std::cos(3 * y + 1.4F * phase);
                value += 0.75F * std::exp(-70 * (a * a + b * b));
              }
              return std::clamp(value, 0.0F, 1.0F);
            };
            std::vector<Colour> colours, opacities;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              colours.push_back({static_cast<std::uint8_t>(120 + 110 * at),
                                 static_cast<std::uint8_t>(200 - 120 * at * at),
                                 static_cast<std::uint8_t>(70 + 60 * std::sin(8 * at)),
                                 static_cast<std::uint8_t>(std::lround(20 + 160 * at))});
              const float rise = std::clamp((at - 0.05F) / 0.5F, 0.0F, 1.0F);
              opacities.push_back({static_cast<std::uint8_t>(std::lround(20 + 235 * rise)), 0, 0, 255});
            }
            upload_volume(canvas, 0, sampled(48, roots));
            upload_table_1d(canvas, 1, colours);
            upload_table_1d(canvas, 2, opacities);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 30, .elevation = 18, .distance = 2.4F, .degrees_each_frame = 2.5F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.9F, 0.88F, 0.8F);
              program.use();
              program.set("modelViewProjection", camera.clip_from_object());
              program.set("cameraInVolume", camera.eye);
              program.set("stepLength", 0.0125F);
              program.set("gradientScale", 4.0F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
