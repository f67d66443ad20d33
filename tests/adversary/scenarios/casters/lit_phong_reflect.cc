// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario lit_phong_reflect() {
  return {
      .sentence =
          "Phong's light with reflect(), GLSL 3.30; the light's position is a uniform that equals the eye's. "
          "Three balls and a ring.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330
layout(location = 0) in vec3 position;
uniform mat4 ModelViewProjection;
out vec3 TexCoord;
void main()
{
    TexCoord = position;
    gl_Position = ModelViewProjection * vec4(position, 1.0);
}
)",
                                  R"(#version 330
in vec3 TexCoord;
layout(location = 0) out vec4 FragColor;

uniform sampler3D VolumeTex;
uniform sampler2D TransferTex;
uniform vec3 CameraPos;
uniform vec3 LightPos;
uniform vec3 TexelSize;
uniform float StepSize;

const float Ka = 0.2;
const float Kd = 0.7;
const float Ks = 0.25;
const float Shininess = 20.0;

vec3 ComputeNormal(vec3 p)
{
    vec3 lower, upper;
    lower.x = texture(VolumeTex, p - vec3(TexelSize.x, 0.0, 0.0)).r;
    upper.x = texture(VolumeTex, p + vec3(TexelSize.x, 0.0, 0.0)).r;
    lower.y = texture(VolumeTex, p - vec3(0.0, TexelSize.y, 0.0)).r;
    upper.y = texture(VolumeTex, p + vec3(0.0, TexelSize.y, 0.0)).r;
    lower.z = texture(VolumeTex, p - vec3(0.0, 0.0, TexelSize.z)).r;
    upper.z = texture(VolumeTex, p + vec3(0.0, 0.0, TexelSize.z)).r;
    vec3 d = lower - upper;
    float len = length(d);
    return len > 0.0 ? d / len : vec3(0.0);
}

vec3 Phong(vec3 base, vec3 p)
{
    vec3 N = ComputeNormal(p);
    vec3 L = normalize(LightPos - p);
    vec3 V = normalize(CameraPos - p);
    vec3 R = reflect(-L, N);
    float lambert = max(dot(N, L), 0.0);
    float highlight = lambert > 0.0 ? pow(max(dot(R, V), 0.0), Shininess) : 0.0;
    return base * (Ka + Kd * lambert) + vec3(Ks * highlight);
}

void main()
{
    vec3 step = StepSize * normalize(TexCoord - CameraPos);
    vec3 p = TexCoord;
    vec4 dst = vec4(0.0);
    for (int i = 0; i < 512; i++)
    {
        vec4 src = texture(TransferTex, vec2(texture(VolumeTex, p).r, 0.5));
        if (src.a > 0.0)
        {
            src.rgb = Phong(src.rgb, p);
            src.rgb *= src.a;
            dst = (1.0 - dst.a) * src + dst;
        }
        p += step;
        if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) break;
    }
    FragColor = dst;
}
)");
        const VertexBuffer box(canvas);
        const Field field = [](float x, float y, float z) {
          const auto ball = [&](Vector centre, float amount, float narrow) {
            const Vector from = Vector{x, y, z} - centre;
            return 1 - amount * std::exp(-narrow * dot(from, from));
          };
          const float around = std::hypot(x - 0.5F, z - 0.5F) - 0.33F, above = y - 0.35F;
          const float ring = 1 - 0.6F * std::exp(-110 * (around * around + above * above));
          return 1 - ring * ball({0.38F, 0.58F, 0.42F}, 0.93F, 22) * ball({0.68F, 0.42F, 0.6F}, 0.8F, 40) *
                         ball({0.62F, 0.74F, 0.27F}, 0.7F, 60);
        };
        std::vector<Colour> materials;
        for (int i = 0; i < 256; ++i) {
          const double at = i / 255.0;
          const auto near = [&](double value, double width) {
            return std::exp(-(at - value) * (at - value) / (width * width));
          };
          const double skin = near(0.24, 0.075), flesh = near(0.5, 0.08), core = near(0.82, 0.1);
          const double all = skin + flesh + core + 1e-9;
          const auto byte = [](double value) {
            return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
          };
          materials.push_back({byte((0.74 * skin + 0.3 * flesh + 0.72 * core) / all),
                               byte((0.45 * skin + 0.6 * flesh + 0.7 * core) / all),
                               byte((0.32 * skin + 0.74 * flesh + 0.4 * core) / all),
                               byte(0.08 * skin + 0.13 * flesh + 0.3 * core)});
        }
        upload_volume(canvas, 0, sampled(64, field));
        upload_table_2d(canvas, 1, materials);
        return [&canvas, program, box](int frame) {
          const Camera camera = camera_at({}, frame);
          canvas.begin(0.05F, 0.05F, 0.08F);
          program.use();
          program.set("VolumeTex", 0);
          program.set("TransferTex", 1);
          program.set("ModelViewProjection", camera.clip_from_object());
          program.set("CameraPos", camera.eye);
          program.set("LightPos", camera.eye);
          program.set("TexelSize", Vector{1 / 64.0F, 1 / 64.0F, 1 / 64.0F});
          program.set("StepSize", 0.018F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          box.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
