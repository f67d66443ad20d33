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

Scenario fades_switched_on_later() {
  return {
      .sentence =
          "Toadstools of 56 x 40 x 48 bytes in GLSL 1.40 under Lambert's light from the eye; at frame 10 "
          "the user switches gradient opacity on, by a table of 256 bytes that was there before.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 140

in vec3 position;

uniform mat4 toClip;
uniform vec3 viewer;

out vec3 start;
out vec3 fromViewer;

void main() {
    start = position;
    fromViewer = position - viewer;
    gl_Position = toClip * vec4(position, 1.0);
}
)",
                                  R"(#version 140

uniform sampler3D scan;
uniform sampler2D ramp;
uniform sampler2D edgeRamp;
uniform bool edgesOnly;
uniform float edgeScale;
uniform float spacing;

in vec3 start;
in vec3 fromViewer;
out vec4 result;

vec3 centralDifference(vec3 at) {
    vec3 e = 1.0 / vec3(textureSize(scan, 0));
    float x0 = texture(scan, vec3(at.x - e.x, at.y, at.z)).r;
    float x1 = texture(scan, vec3(at.x + e.x, at.y, at.z)).r;
    float y0 = texture(scan, vec3(at.x, at.y - e.y, at.z)).r;
    float y1 = texture(scan, vec3(at.x, at.y + e.y, at.z)).r;
    float z0 = texture(scan, vec3(at.x, at.y, at.z - e.z)).r;
    float z1 = texture(scan, vec3(at.x, at.y, at.z + e.z)).r;
    return 0.5 * vec3(x0 - x1, y0 - y1, z0 - z1);
}

void main() {
    vec3 ray = normalize(fromViewer);
    vec3 ends = (step(0.0, ray) - start) / ray;
    float tEnd = min(min(ends.x, ends.y), ends.z);

    vec3 light = vec3(0.0);
    float transparency = 1.0;
    for (float t = 0.5 * spacing; t < tEnd; t += spacing) {
        vec3 at = start + t * ray;
        vec4 c = texture(ramp, vec2(texture(scan, at).r, 0.5));
        vec3 gradient = centralDifference(at);
        float size = length(gradient);
        vec3 n = size > 0.0 ? gradient / size : vec3(0.0);
        float shade = 0.3 + 0.7 * max(dot(n, -ray), 0.0);
        if (edgesOnly)
            c.a *= texture(edgeRamp, vec2(clamp(edgeScale * size, 0.0, 1.0), 0.5)).r;
        light += transparency * c.a * shade * c.rgb;
        transparency *= 1.0 - c.a;
    }
    result = vec4(light, 1.0 - transparency);
}
)");
        const VertexBuffer vertices(canvas);
        const Field toadstools = [](float x, float y, float z) {
          const auto cap = [&](float cx, float cy, float cz, float amount, float narrow) {
            const float a = x - cx, b = 1.6F * (y - cy), c = z - cz;
            return 1 - amount * std::exp(-narrow * (a * a + b * b + c * c));
          };
          const auto stem = [&](float cx, float cz, float narrow) {
            const float a = x - cx, c = z - cz;
            return 1 - 0.45F * std::exp(-narrow * (a * a + c * c)) / (1 + std::exp(20 * (y - 0.6F)));
          };
          const float caps = cap(0.32F, 0.66F, 0.4F, 0.85F, 20) * cap(0.7F, 0.56F, 0.66F, 0.8F, 70) *
                             cap(0.66F, 0.4F, 0.25F, 0.75F, 40);
          return 1 - caps * stem(0.32F, 0.4F, 120) * stem(0.7F, 0.66F, 200);
        };
        std::vector<Colour> ramp;
        std::vector<std::uint8_t> edges;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float flesh = std::clamp((at - 0.15F) / 0.2F, 0.0F, 1.0F);
          ramp.push_back({static_cast<std::uint8_t>(160 + 80 * at), static_cast<std::uint8_t>(190 - 150 * at),
                          static_cast<std::uint8_t>(140 - 90 * at),
                          static_cast<std::uint8_t>(std::lround(34 * flesh))});
          const float peak = std::max(0.0F, 1 - std::abs(at - 0.65F) / 0.35F);
          edges.push_back(static_cast<std::uint8_t>(std::lround(255 * peak)));
        }
        upload_volume(canvas, 0, sampled(56, 40, 48, toadstools));
        upload_table_2d(canvas, 1, ramp);
        GLuint name = 0;
        canvas.gl.GenTextures(1, &name);
        canvas.gl.ActiveTexture(GL_TEXTURE2);
        canvas.gl.BindTexture(GL_TEXTURE_2D, name);
        filter_linearly(canvas, GL_TEXTURE_2D);
        canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, 256, 1, 0, GL_RED, GL_UNSIGNED_BYTE, edges.data());
        program.use();
        program.set("scan", 0);
        program.set("ramp", 1);
        program.set("edgeRamp", 2);
        program.set("edgeScale", 5.0F);
        program.set("spacing", 0.017F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 245, .elevation = 24, .distance = 2.4F, .degrees_each_frame = 2};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.12F, 0.1F, 0.18F);
          program.use();
          program.set("toClip", camera.clip_from_object());
          program.set("viewer", camera.eye);
          program.set("edgesOnly", frame < 10 ? 0 : 1);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
