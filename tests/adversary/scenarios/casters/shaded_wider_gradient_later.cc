// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shaded_wider_gradient_later() {
  return {
      .sentence =
          "A noisy scan of 52 x 44 x 48 luminance bytes, Phong's light from the eye, GLSL 1.30; at frame "
          "12 the user smooths the normals: differences over 2.5 texels in place of one.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 130
uniform vec3 eyePosition;
out vec3 startPoint;
out vec3 rayDirection;
void main()
{
    startPoint = gl_MultiTexCoord0.xyz;
    rayDirection = startPoint - eyePosition;
    gl_Position = ftransform();
}
)",
                                  R"(#version 130
uniform sampler3D scan;
uniform sampler2D lookup;
uniform vec3 voxel;
uniform float smoothing;
uniform float increment;
in vec3 startPoint;
in vec3 rayDirection;

vec3 surfaceNormal(vec3 q)
{
    vec3 h = smoothing * voxel;
    vec3 n;
    n.x = texture(scan, q - vec3(h.x, 0.0, 0.0)).r - texture(scan, q + vec3(h.x, 0.0, 0.0)).r;
    n.y = texture(scan, q - vec3(0.0, h.y, 0.0)).r - texture(scan, q + vec3(0.0, h.y, 0.0)).r;
    n.z = texture(scan, q - vec3(0.0, 0.0, h.z)).r - texture(scan, q + vec3(0.0, 0.0, h.z)).r;
    return n / max(length(n), 0.00001);
}

void main()
{
    vec3 dir = normalize(rayDirection);
    vec3 stepVector = dir * increment;
    vec3 q = startPoint;
    vec4 total = vec4(0.0);
    for (int i = 0; i < 180; i++)
    {
        vec4 s = texture(lookup, vec2(texture(scan, q).r, 0.5));
        vec3 n = surfaceNormal(q);
        float d = max(dot(n, -dir), 0.0);
        vec3 r = 2.0 * dot(n, -dir) * n + dir;
        float p = pow(max(dot(r, -dir), 0.0), 10.0);
        s.rgb = s.rgb * (0.18 + 0.7 * d) + vec3(0.2 * p);
        total.rgb += (1.0 - total.a) * s.a * s.rgb;
        total.a += (1.0 - total.a) * s.a;
        q += stepVector;
        vec3 outside = abs(q - 0.5);
        if (max(outside.x, max(outside.y, outside.z)) > 0.5)
            break;
    }
    gl_FragColor = total;
}
)");
        const Field scan = [](float x, float y, float z) {
          const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
          const float body = 1.05F - 1.65F * std::sqrt(u * u + 1.2F * v * v + w * w) +
                             0.12F * std::sin(9 * x + 4) * std::cos(8 * y) + 0.1F * std::sin(10 * z - 5 * y);
          const float speckle =
              std::sin(71 * x + 43 * y) * std::sin(67 * y - 59 * z) * std::sin(73 * z + 31 * x);
          return std::clamp(body + 0.05F * speckle, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float body = std::clamp((at - 0.3F) / 0.15F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(230 - 50 * at), static_cast<std::uint8_t>(150 + 80 * at),
                           static_cast<std::uint8_t>(130 + 100 * at),
                           static_cast<std::uint8_t>(std::lround(70 * body))});
        }
        upload_volume(canvas, 0, sampled(52, 44, 48, scan), {.shown = Shown::luminance});
        upload_table_2d(canvas, 1, table);
        return [&canvas, program, corners = box_triangles()](int frame) {
          const Camera camera = old_camera(
              canvas, frame, {.azimuth = 100, .elevation = 28, .distance = 2.25F, .degrees_each_frame = 2});
          begin_old_frame(canvas, camera);
          program.use();
          program.set("scan", 0);
          program.set("lookup", 1);
          program.set("eyePosition", camera.eye);
          program.set("voxel", Vector{1 / 52.0F, 1 / 44.0F, 1 / 48.0F});
          program.set("smoothing", frame < 12 ? 1.0F : 2.5F);
          program.set("increment", 0.014F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          canvas.gl.EnableClientState(GL_VERTEX_ARRAY);
          canvas.gl.EnableClientState(GL_TEXTURE_COORD_ARRAY);
          canvas.gl.VertexPointer(3, GL_FLOAT, sizeof(Vector), corners.data());
          canvas.gl.TexCoordPointer(3, GL_FLOAT, sizeof(Vector), corners.data());
          canvas.gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
          canvas.gl.DisableClientState(GL_TEXTURE_COORD_ARRAY);
          canvas.gl.DisableClientState(GL_VERTEX_ARRAY);
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
