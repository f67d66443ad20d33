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

Scenario fades_bulbs_in_a_long_box() {
  return {.sentence =
              "Bulbs with soft and with sharp rims, 60 x 24 x 40 bytes in a box that is no cube, GLSL 4.10; "
              "gradients are divided by the spacing, their length looks up a row of 256 bytes that "
              "multiplies the corrected opacity, Blinn-Phong from the eye.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 corner;
uniform mat4 clipFromWorld;
uniform vec3 low;
uniform vec3 high;
out vec3 entryWorld;
void main() {
  entryWorld = mix(low, high, corner);
  gl_Position = clipFromWorld * vec4(entryWorld, 1.0);
}
)",
                                      R"(#version 410 core
in vec3 entryWorld;
layout(location = 0) out vec4 fragment;
uniform sampler3D density;
uniform sampler2D materials;
uniform sampler2D slopes;
uniform vec3 eyeWorld;
uniform vec3 low;
uniform vec3 high;
uniform vec3 spacing;
uniform float slopeScale;
uniform float sampleDistance;
uniform float referenceDistance;

float densityAt(vec3 world) { return texture(density, (world - low) / (high - low)).r; }

vec3 gradientAt(vec3 world) {
  vec3 ex = vec3(spacing.x, 0.0, 0.0), ey = vec3(0.0, spacing.y, 0.0), ez = vec3(0.0, 0.0, spacing.z);
  vec3 ahead = vec3(densityAt(world + ex), densityAt(world + ey), densityAt(world + ez));
  vec3 behind = vec3(densityAt(world - ex), densityAt(world - ey), densityAt(world - ez));
  return (ahead - behind) / (2.0 * spacing);
}

void main() {
  vec3 view = normalize(entryWorld - eyeWorld);
  vec3 exits = (mix(low, high, step(0.0, view)) - entryWorld) / view;
  float tEnd = min(exits.x, min(exits.y, exits.z));

  vec4 composite = vec4(0.0);
  for (float t = 0.5 * sampleDistance; t < tEnd; t += sampleDistance) {
    vec3 world = entryWorld + t * view;
    vec4 material = texture(materials, vec2(densityAt(world), 0.5));
    vec3 gradient = gradientAt(world);
    float steepness = length(gradient);
    float alpha = 1.0 - pow(1.0 - material.a, sampleDistance / referenceDistance);
    alpha *= texture(slopes, vec2(clamp(slopeScale * steepness, 0.0, 1.0), 0.5)).r;
    vec3 normal = -gradient / max(steepness, 1e-5);
    vec3 halfway = normalize(-view - view);
    float diffuse = max(dot(normal, -view), 0.0);
    float specular = pow(max(dot(normal, halfway), 0.0), 18.0);
    vec3 lit = (0.3 + 0.6 * diffuse) * material.rgb + vec3(0.2 * specular);
    composite.rgb += (1.0 - composite.a) * alpha * lit;
    composite.a += (1.0 - composite.a) * alpha;
  }
  fragment = composite;
}
)");
            const VertexBuffer vertices(canvas);
            constexpr Vector lowest{0, 0.15F, 0.075F}, highest{1, 0.85F, 0.925F};
            // Of places in the world.
            const Field bulbs = [=](float x, float y, float z) {
              const float wx = lowest.x + x * (highest.x - lowest.x);
              const float wy = lowest.y + y * (highest.y - lowest.y);
              const float wz = lowest.z + z * (highest.z - lowest.z);
              const auto outside = [&](float cx, float cy, float cz, float amount, float narrow) {
                const float a = wx - cx, b = wy - cy, c = wz - cz;
                return 1 - amount * std::exp(-narrow * (a * a + b * b + c * c));
              };
              const float ry = wy - 0.52F, rz = wz - 0.5F;
              const float rod = 1 - 0.5F * std::exp(-150 * (ry * ry + rz * rz));
              const float soft = outside(0.27F, 0.48F, 0.42F, 0.78F, 22);
              const float sharp = outside(0.7F, 0.4F, 0.64F, 0.82F, 80) * outside(0.6F, 0.64F, 0.3F, 0.75F, 45);
              return 1 - rod * soft * sharp;
            };
            std::vector<Colour> materials;
            std::vector<std::uint8_t> slopes;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float rind = std::exp(-std::pow((at - 0.27F) / 0.09F, 2.0F));
              const float core = std::exp(-std::pow((at - 0.65F) / 0.13F, 2.0F));
              materials.push_back({static_cast<std::uint8_t>(90 + 140 * core),
                                   static_cast<std::uint8_t>(190 - 60 * at),
                                   static_cast<std::uint8_t>(220 - 170 * core),
                                   static_cast<std::uint8_t>(std::lround(50 * rind + 90 * core))});
              const float steep = std::clamp((at - 0.14F) / 0.5F, 0.0F, 1.0F);
              slopes.push_back(static_cast<std::uint8_t>(std::lround(255 * steep)));
            }
            upload_volume(canvas, 0, sampled(60, 24, 40, bulbs));
            upload_table_2d(canvas, 1, materials);
            GLuint name = 0;
            canvas.gl.GenTextures(1, &name);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.BindTexture(GL_TEXTURE_2D, name);
            filter_linearly(canvas, GL_TEXTURE_2D);
            canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, 256, 1, 0, GL_RED, GL_UNSIGNED_BYTE, slopes.data());
            return [=, &canvas](int frame) {
              const Orbit orbit{.azimuth = -35, .elevation = 27, .distance = 2.4F, .degrees_each_frame = 3};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.1F, 0.12F, 0.2F);
              program.use();
              program.set("density", 0);
              program.set("materials", 1);
              program.set("slopes", 2);
              program.set("clipFromWorld", camera.clip_from_object());
              program.set("eyeWorld", camera.eye);
              program.set("low", lowest);
              program.set("high", highest);
              program.set("spacing", Vector{(highest.x - lowest.x) / 60, (highest.y - lowest.y) / 24,
                                            (highest.z - lowest.z) / 40});
              program.set("slopeScale", 0.13F);
              program.set("sampleDistance", 0.017F);
              program.set("referenceDistance", 0.02F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
