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

Scenario fades_limb_in_hounsfield() {
  return {.sentence =
              "A limb of 40 x 48 x 36 floats in Hounsfield units, GLSL 4.50, neighbours by textureOffset(): "
              "dense muscle and bone, of which a 1-D table of 256 floats, by the gradient's length in "
              "texels, leaves the rims alone; Blinn-Phong from the eye, normals guarded.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 vertPosition;
uniform mat4 MVP;
out vec3 EntryPoint;
void main() {
  EntryPoint = vertPosition;
  gl_Position = MVP * vec4(vertPosition, 1.0);
}
)",
                                      R"(#version 450 core
in vec3 EntryPoint;
uniform sampler3D CT;
uniform sampler1D Tissues;
uniform sampler1D Rims;
uniform vec3 CameraPos;
uniform vec2 Window;
uniform float RimScale;
uniform float StepSize;
layout(location = 0) out vec4 FragColor;

vec3 gradient(vec3 p) {
  return 0.5 * vec3(textureOffset(CT, p, ivec3(1, 0, 0)).x - textureOffset(CT, p, ivec3(-1, 0, 0)).x,
                    textureOffset(CT, p, ivec3(0, 1, 0)).x - textureOffset(CT, p, ivec3(0, -1, 0)).x,
                    textureOffset(CT, p, ivec3(0, 0, 1)).x - textureOffset(CT, p, ivec3(0, 0, -1)).x);
}

void main() {
  vec3 dir = normalize(EntryPoint - CameraPos);
  vec3 toView = -dir;
  vec3 p = EntryPoint;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 150; i++) {
    float hu = texture(CT, p).x;
    vec4 tissue = texture(Tissues, (hu - Window.x) / Window.y);
    vec3 g = gradient(p);
    float magnitude = length(g);
    tissue.a *= texture(Rims, clamp(magnitude * RimScale, 0.0, 1.0)).r;
    vec3 n = magnitude > 0.0 ? -g / magnitude : vec3(0.0);
    vec3 h = normalize(toView + toView);
    tissue.rgb = tissue.rgb * (0.3 + 0.6 * max(dot(n, toView), 0.0)) + 0.2 * pow(max(dot(n, h), 0.0), 20.0);
    sum.rgb += (1.0 - sum.a) * tissue.a * tissue.rgb;
    sum.a += (1.0 - sum.a) * tissue.a;

    p += dir * StepSize;
    if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0))))
      break;
  }
  FragColor = sum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field limb = [](float x, float y, float z) {
              const auto inside = [](float depth, float width) { return 1 / (1 + std::exp(-depth / width)); };
              const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
              const float bent = u - 0.06F * std::sin(5 * v);
              const float round = std::sqrt(bent * bent + 1.2F * w * w);
              const float skin = 0.4F + 0.03F * std::sin(6 * v) - round;
              const float muscle = 0.29F + 0.04F * std::sin(9 * v + 4 * std::atan2(w, u + 1.2F)) - round;
              const auto bone = [&](float bx, float bz, float radius) {
                return radius + 0.12F * v * v - std::hypot(bent - bx, w - bz);
              };
              return -1000 + 900 * inside(skin, 0.02F) + 150 * inside(muscle, 0.016F) +
                     1150 * std::max(inside(bone(-0.1F, 0.04F, 0.085F), 0.018F),
                                     inside(bone(0.11F, -0.05F, 0.06F), 0.018F));
            };
            std::vector<Colour> tissues;
            std::vector<float> rims;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float bone = std::clamp((at - 0.48F) / 0.12F, 0.0F, 1.0F);
              const float muscle = std::clamp((at - 0.34F) / 0.06F, 0.0F, 1.0F) * (1 - bone);
              const float skin = std::exp(-std::pow((at - 0.2F) / 0.08F, 2.0F));
              const float opacity = 26 * skin + 110 * muscle + 170 * bone;
              tissues.push_back({static_cast<std::uint8_t>(200 + 40 * bone),
                                 static_cast<std::uint8_t>(160 - 100 * muscle + 70 * bone),
                                 static_cast<std::uint8_t>(130 - 70 * muscle + 70 * bone),
                                 static_cast<std::uint8_t>(std::lround(opacity))});
              rims.push_back(std::clamp((at - 0.06F) / 0.5F, 0.0F, 1.0F));
            }
            upload_volume(canvas, 0, sampled(40, 48, 36, limb), {.texel = Texel::float32});
            upload_table_1d(canvas, 1, tissues);
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_1D, name);
            filter_linearly(canvas, GL_TEXTURE_1D);
            canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_R32F, 256, 0, GL_RED, GL_FLOAT, rims.data());
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 15, .elevation = 24, .distance = 2.4F, .degrees_each_frame = -2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.1F, 0.15F, 0.2F);
              program.use();
              program.set("MVP", camera.clip_from_object());
              program.set("CameraPos", camera.eye);
              program.set("CT", 0);
              program.set("Tissues", 1);
              program.set("Rims", 2);
              canvas.gl.Uniform2f(program.location("Window"), -1000.0F, 2500.0F);
              program.set("RimScale", 1 / 300.0F);
              program.set("StepSize", 0.016F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
