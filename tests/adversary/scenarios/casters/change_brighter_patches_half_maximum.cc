// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario change_brighter_patches_half_maximum() {
  return {
      .sentence =
          "A maximum of half floats, grey between two limits in uniforms. A plane in a uniform moves slowly "
          "into the "
          "volume and hides what is before it; from frame 10 on every third frame replaces a box of texels, by "
          "values that become larger than any before.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17,
                     18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 position;
uniform mat4 MVP;
out vec3 entry;
void main()
{
    entry = position;
    gl_Position = MVP * vec4(position, 1.0);
}
)",
                                  R"(#version 400 core
uniform sampler3D Data;
uniform vec3 EyePosition;
uniform vec4 ClipPlane;
uniform vec2 DisplayRange;
uniform float SampleDistance;
in vec3 entry;
out vec4 FragColor;

void main()
{
    vec3 ray = normalize(entry - EyePosition);
    vec3 toFaces = mix(-entry, vec3(1.0) - entry, greaterThan(ray, vec3(0.0))) / ray;
    float rayLength = min(toFaces.x, min(toFaces.y, toFaces.z));
    int samples = int(floor(rayLength / SampleDistance)) + 1;
    float maxValue = 0.0;
    for (int n = 0; n < samples; n++)
    {
        vec3 pos = entry + ray * (float(n) * SampleDistance);
        if (dot(vec4(pos, 1.0), ClipPlane) < 0.0)
            continue;
        maxValue = max(maxValue, texture(Data, pos).x);
    }
    float g = clamp((maxValue - DisplayRange.x) / (DisplayRange.y - DisplayRange.x), 0.0, 1.0);
    FragColor = vec4(g, g * g, 0.3 * g + 0.2, 1.0);
}
)");
        const VertexBuffer vertices(canvas);
        const VolumeFormat format{.texel = Texel::half};
        const Field vessels = [](float x, float y, float z) {
          const float a = y - 0.5F - 0.25F * std::sin(6 * x), b = z - 0.5F - 0.25F * std::cos(5 * x);
          const float c = x - 0.4F - 0.2F * std::sin(7 * z), d = y - 0.35F - 0.2F * z;
          return 0.15F + 0.1F * std::sin(9 * x + 7 * y - 4 * z) + 0.9F * std::exp(-90 * (a * a + b * b)) +
                 0.7F * std::exp(-60 * (c * c + d * d));
        };
        const GLuint volume = upload_volume(canvas, 0, sampled(44, 52, 48, vessels), format);
        program.use();
        program.set("Data", 0);
        program.set("SampleDistance", 0.011F);
        return [&canvas, program, vertices, format, volume](int frame) {
          if (frame >= 10 && (frame - 10) % 3 == 0) {
            const int which = (frame - 10) / 3;
            const Grid patch = sampled(14, 12, 16, [which](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.5F, c = z - 0.5F;
              const float edge = std::clamp(1 - 4 * (a * a + b * b + c * c), 0.0F, 1.0F);
              return 0.2F +
                     (0.5F + 0.25F * static_cast<float>(which)) * edge * (1 + 0.3F * std::sin(9 * x + 8 * z));
            });
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            canvas.gl.BindTexture(GL_TEXTURE_3D, volume);
            replace_texels(canvas, patch, format, 4 + 4 * which, 30 - 4 * which, 6 + (11 * which) % 24);
          }
          const Camera camera =
              camera_at({.azimuth = -35, .elevation = 28, .degrees_each_frame = 2.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const Vector normal = normalized({-0.8F, -0.3F, -0.5F});
          const float moved = 0.012F * static_cast<float>(std::max(frame - 4, 0));
          canvas.begin(0.02F, 0.1F, 0.15F);
          program.use();
          program.set("MVP", camera.clip_from_object());
          program.set("EyePosition", camera.eye);
          canvas.gl.Uniform4f(program.location("ClipPlane"), normal.x, normal.y, normal.z,
                              -dot(normal, {1, 1, 1}) - moved + 0.01F);
          canvas.gl.Uniform2f(program.location("DisplayRange"), 0.1F, frame < 20 ? 1.2F : 1.9F);
          set_blending(canvas.gl, Blending::off);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
