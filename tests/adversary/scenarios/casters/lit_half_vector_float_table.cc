// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario lit_half_vector_float_table() {
  return {
      .sentence =
          "Blinn and Phong's light from the eye, GLSL 4.50 with texel offsets; the table is of 128 RGBA "
          "floats and is edited at frames 10 and 20.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 uViewProjection;
layout(location = 0) out vec3 vPosition;
void main() {
    vPosition = position;
    gl_Position = uViewProjection * vec4(position, 1.0);
}
)",
                                  R"(#version 450 core
layout(location = 0) in vec3 vPosition;
layout(location = 0) out vec4 oColor;
layout(binding = 0) uniform sampler3D uVolume;
layout(binding = 1) uniform sampler2D uTransfer;
layout(location = 4) uniform vec3 uEye;
layout(location = 5) uniform float uStep;

vec3 gradientAt(in vec3 p) {
    const vec3 ahead = vec3(textureLodOffset(uVolume, p, 0.0, ivec3(1, 0, 0)).x,
                            textureLodOffset(uVolume, p, 0.0, ivec3(0, 1, 0)).x,
                            textureLodOffset(uVolume, p, 0.0, ivec3(0, 0, 1)).x);
    const vec3 behind = vec3(textureLodOffset(uVolume, p, 0.0, ivec3(-1, 0, 0)).x,
                             textureLodOffset(uVolume, p, 0.0, ivec3(0, -1, 0)).x,
                             textureLodOffset(uVolume, p, 0.0, ivec3(0, 0, -1)).x);
    return ahead - behind;
}

void main() {
    const vec3 rd = normalize(vPosition - uEye);
    const vec3 farPlanes = max((vec3(0.0) - vPosition) / rd, (vec3(1.0) - vPosition) / rd);
    const float tExit = min(farPlanes.x, min(farPlanes.y, farPlanes.z));

    vec4 acc = vec4(0.0);
    float t = 0.0;
    while (t < tExit) {
        const vec3 p = fma(vec3(t), rd, vPosition);
        vec4 s = textureLod(uTransfer, vec2(textureLod(uVolume, p, 0.0).x, 0.5), 0.0);
        if (s.a > 0.0) {
            const vec3 g = gradientAt(p);
            const float m = dot(g, g);
            const vec3 n = m > 1e-12 ? -g * inversesqrt(m) : vec3(0.0);
            const vec3 v = -rd;
            const vec3 l = v;
            const vec3 h = normalize(l + v);
            s.rgb = s.rgb * (0.3 + 0.6 * max(dot(n, l), 0.0)) + 0.2 * pow(max(dot(n, h), 0.0), 32.0);
            acc += (1.0 - acc.a) * vec4(s.rgb * s.a, s.a);
        }
        t += uStep;
    }
    oColor = acc;
}
)");
        const VertexBuffer box(canvas);
        // A spiral tube around a thick stem with a bulge.
        const Field field = [](float x, float y, float z) {
          const float turn = 11 * y;
          const float a = x - 0.5F - 0.27F * std::cos(turn), b = z - 0.5F - 0.27F * std::sin(turn);
          const float tube = 0.65F * std::exp(-95 * (a * a + b * b));
          const float u = x - 0.5F, v = y - 0.55F, w = z - 0.5F;
          const float stem = 0.95F * std::exp(-(60 - 30 * std::exp(-30 * v * v)) * (u * u + w * w));
          return 1 - (1 - tube) * (1 - stem);
        };
        upload_volume(canvas, 0, sampled(64, field));
        const auto table = [](float first, float second, float strength) {
          std::vector<float> texels;
          for (int i = 0; i < 128; ++i) {
            const float at = static_cast<float>(i) / 127;
            const float a = std::exp(-std::pow((at - first) / 0.08F, 2.0F));
            const float b = std::exp(-std::pow((at - second) / 0.11F, 2.0F));
            const float share = b / (a + b + 1e-12F);
            for (const float value : {0.7F - 0.5F * share, 0.35F + 0.35F * share, 0.3F + 0.42F * share * share,
                                      at < 0.04F ? 0.0F : 0.09F * a + strength * b})
              texels.push_back(value);
          }
          return texels;
        };
        GLuint name = 0;
        canvas.gl.GenTextures(1, &name);
        canvas.gl.ActiveTexture(GL_TEXTURE1);
        canvas.gl.BindTexture(GL_TEXTURE_2D, name);
        filter_linearly(canvas, GL_TEXTURE_2D);
        canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 128, 1, 0, GL_RGBA, GL_FLOAT,
                             table(0.3F, 0.7F, 0.25F).data());
        return [&canvas, program, box, table](int frame) {
          if (frame == 10 || frame == 20) {
            const auto edited = frame == 10 ? table(0.4F, 0.85F, 0.35F) : table(0.72F, 0.3F, 0.12F);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 128, 1, GL_RGBA, GL_FLOAT, edited.data());
          }
          const Camera camera = camera_at({.azimuth = 60, .elevation = 12, .degrees_each_frame = 2}, frame);
          canvas.begin(0, 0, 0);
          program.use();
          program.set("uViewProjection", camera.clip_from_object());
          program.set("uEye", camera.eye);
          program.set("uStep", 0.018F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          box.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
