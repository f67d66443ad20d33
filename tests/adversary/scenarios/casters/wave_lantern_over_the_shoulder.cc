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

Scenario wave_lantern_over_the_shoulder() {
  return {
      .sentence =
          "A shell of 48 x 40 x 44 bytes in GLSL 4.30, lit by a lantern that goes with the eye, to its right "
          "and above it by about ten degrees; eye and lantern are flat varyings whose names are exchanged "
          "between the shaders, which match by location; gradients of one texel, normals divided by length + "
          "1e-3.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 430 core
layout(location = 0) in vec3 vertex;

layout(location = 0) uniform mat4 transform;
layout(location = 1) uniform vec3 eye;
layout(location = 2) uniform vec3 lantern;

layout(location = 0) out vec3 along;
layout(location = 1) flat out vec3 first;
layout(location = 2) flat out vec3 second;

void main()
{
    along = vertex - eye;
    first = eye;
    second = lantern;
    gl_Position = transform * vec4(vertex, 1.0);
}
)",
                                  R"(#version 430 core
layout(location = 0) in vec3 along;
layout(location = 2) flat in vec3 first;   // the lantern
layout(location = 1) flat in vec3 second;  // the eye

layout(location = 0) out vec4 fragment;

layout(binding = 0) uniform sampler3D shell;
layout(binding = 1) uniform sampler2D pearl;
layout(location = 6) uniform float delta;

vec3 gradientAt(vec3 p)
{
    vec3 d = 1.0 / vec3(textureSize(shell, 0));
    return vec3(texture(shell, p + d * vec3(1, 0, 0)).r - texture(shell, p - d * vec3(1, 0, 0)).r,
                texture(shell, p + d * vec3(0, 1, 0)).r - texture(shell, p - d * vec3(0, 1, 0)).r,
                texture(shell, p + d * vec3(0, 0, 1)).r - texture(shell, p - d * vec3(0, 0, 1)).r);
}

void main()
{
    vec3 w = normalize(along);
    vec3 nearPlanes = (mix(vec3(1.0), vec3(0.0), greaterThan(w, vec3(0.0))) - second) / w;
    vec3 farPlanes = (mix(vec3(0.0), vec3(1.0), greaterThan(w, vec3(0.0))) - second) / w;
    float begin = max(0.0, max(nearPlanes.x, max(nearPlanes.y, nearPlanes.z)));
    float end = min(farPlanes.x, min(farPlanes.y, farPlanes.z));

    vec4 c = vec4(0.0);
    for (float t = begin; t < end; t += delta) {
        vec3 p = second + t * w;
        vec4 s = texture(pearl, vec2(texture(shell, p).r, 0.5));
        vec3 g = gradientAt(p);
        vec3 n = -g / (length(g) + 1e-3);
        vec3 l = normalize(first - p);
        vec3 h = normalize(l - w);
        s.rgb = s.rgb * (0.2 + 0.65 * max(dot(n, l), 0.0)) + 0.3 * pow(max(dot(n, h), 0.0), 16.0);
        c.rgb += (1.0 - c.a) * s.a * s.rgb;
        c.a += (1.0 - c.a) * s.a;
        if (c.a > 0.95)
            break;
    }
    fragment = c;
}
)");
        const VertexBuffer vertices(canvas);
        const Field shell = [](float x, float y, float z) {
          const float a = x - 0.52F, b = y - 0.48F, c = z - 0.5F;
          const float radius = std::sqrt(a * a + b * b + c * c);
          const float turn = std::atan2(c, a + 1e-6F);
          return std::clamp(0.55F - 0.9F * (radius - 0.25F) + 0.17F * std::sin(3 * turn + 18 * radius), 0.0F,
                            1.0F);
        };
        std::vector<Colour> pearl;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float wall = std::clamp((at - 0.4F) / 0.2F, 0.0F, 1.0F);
          pearl.push_back({static_cast<std::uint8_t>(200 + 30 * std::sin(12 * at)),
                           static_cast<std::uint8_t>(190 - 60 * at), static_cast<std::uint8_t>(120 + 100 * at),
                           static_cast<std::uint8_t>(std::lround(55 * wall))});
        }
        upload_volume(canvas, 0, sampled(48, 40, 44, shell));
        upload_table_2d(canvas, 1, pearl);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 95, .elevation = 24, .distance = 2.4F, .degrees_each_frame = 1.5F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector right{camera.view[0], camera.view[4], camera.view[8]};
          const Vector up{camera.view[1], camera.view[5], camera.view[9]};
          canvas.begin(0.1F, 0.1F, 0.18F);
          program.use();
          program.set("transform", camera.clip_from_object());
          program.set("eye", camera.eye);
          program.set("lantern", camera.eye + 0.3F * right + 0.32F * up);
          program.set("delta", 0.018F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
