// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario lit_anisotropic_voxels() {
  return {
      .sentence =
          "A volume of 64 x 32 x 48 voxels that are no cubes, in a box that is none; gradients are divided by "
          "the spacing, light and steps are in the world's lengths, opacity is corrected for the step.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
in vec3 position;
uniform mat4 worldToClip;
uniform vec3 boxMin;
uniform vec3 boxMax;
out vec3 worldPos;
void main() {
  worldPos = mix(boxMin, boxMax, position);
  gl_Position = worldToClip * vec4(worldPos, 1.0);
}
)",
                                  R"(#version 330 core
in vec3 worldPos;
out vec4 fragment;
uniform sampler3D density;
uniform sampler2D lut;
uniform vec3 cameraWorld;
uniform vec3 boxMin;
uniform vec3 boxMax;
uniform vec3 spacing;
uniform float sampleDistance;
uniform float referenceDistance;

float densityAt(vec3 world) { return texture(density, (world - boxMin) / (boxMax - boxMin)).r; }

vec3 gradient(vec3 world) {
  vec3 ex = vec3(spacing.x, 0.0, 0.0), ey = vec3(0.0, spacing.y, 0.0), ez = vec3(0.0, 0.0, spacing.z);
  return vec3((densityAt(world + ex) - densityAt(world - ex)) / (2.0 * spacing.x),
              (densityAt(world + ey) - densityAt(world - ey)) / (2.0 * spacing.y),
              (densityAt(world + ez) - densityAt(world - ez)) / (2.0 * spacing.z));
}

void main() {
  vec3 view = normalize(worldPos - cameraWorld);
  vec3 inverse_view = 1.0 / view;
  vec3 low = (boxMin - cameraWorld) * inverse_view, high = (boxMax - cameraWorld) * inverse_view;
  vec3 nearest = min(low, high), farthest = max(low, high);
  float tNear = max(nearest.x, max(nearest.y, nearest.z));
  float tFar = min(farthest.x, min(farthest.y, farthest.z));

  vec4 composite = vec4(0.0);
  for (float t = tNear + 0.5 * sampleDistance; t < tFar; t += sampleDistance) {
    vec3 world = cameraWorld + t * view;
    vec4 material = texture(lut, vec2(densityAt(world), 0.5));
    float alpha = 1.0 - pow(1.0 - material.a, sampleDistance / referenceDistance);
    vec3 normal = -gradient(world);
    normal /= max(length(normal), 1e-5);
    float cosine = max(dot(normal, -view), 0.0);
    vec3 lit = (0.25 + 0.6 * cosine) * material.rgb + vec3(0.22 * pow(cosine, 16.0));
    composite.rgb += (1.0 - composite.a) * alpha * lit;
    composite.a += (1.0 - composite.a) * alpha;
  }
  fragment = composite;
}
)");
        const VertexBuffer box(canvas);
        constexpr Vector lowest{0, 0.12F, 0.06F}, highest{1, 0.88F, 0.94F};
        // Of places in the world: a bent body, two organs in it, and a rod through all.
        const Field body = [=](float x, float y, float z) {
          const float wx = lowest.x + x * (highest.x - lowest.x), wy = lowest.y + y * (highest.y - lowest.y),
                      wz = lowest.z + z * (highest.z - lowest.z);
          const auto bulb = [&](float cx, float cy, float cz, float amount, float narrow) {
            const float a = wx - cx, b = wy - cy, c = wz - cz;
            return 1 - amount * std::exp(-narrow * (a * a + b * b + c * c));
          };
          const float bend = wy - 0.5F - 0.12F * std::sin(6 * wx);
          const float trunk = 1 - 0.45F * std::exp(-16 * (bend * bend + (wz - 0.5F) * (wz - 0.5F))) *
                                      std::exp(-40 * std::pow(wx - 0.5F, 4.0F));
          const float rx = wx - 0.55F, rz = wz - 0.45F;
          const float rod = 1 - 0.75F * std::exp(-180 * (rx * rx + rz * rz));
          return 1 - trunk * rod * bulb(0.3F, 0.56F, 0.42F, 0.7F, 70) * bulb(0.72F, 0.45F, 0.62F, 0.8F, 60);
        };
        std::vector<Colour> lut;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float rind = std::exp(-std::pow((at - 0.26F) / 0.07F, 2.0F));
          const float organ = std::exp(-std::pow((at - 0.75F) / 0.14F, 2.0F));
          lut.push_back({static_cast<std::uint8_t>(at < 0.45F ? 120 : 190),
                         static_cast<std::uint8_t>(at < 0.45F ? 160 : 90),
                         static_cast<std::uint8_t>(at < 0.45F ? 190 : 70),
                         static_cast<std::uint8_t>(std::lround(22 * rind + 60 * organ))});
        }
        upload_volume(canvas, 0, sampled(64, 32, 48, body), {.texel = Texel::unsigned16});
        upload_table_2d(canvas, 1, lut);
        return [=, &canvas](int frame) {
          const Camera camera = camera_at({.azimuth = -40, .elevation = 24, .degrees_each_frame = 3}, frame);
          canvas.begin(0.1F, 0.12F, 0.2F);
          program.use();
          program.set("density", 0);
          program.set("lut", 1);
          program.set("worldToClip", camera.clip_from_object());
          program.set("cameraWorld", camera.eye);
          program.set("boxMin", lowest);
          program.set("boxMax", highest);
          program.set("spacing", Vector{(highest.x - lowest.x) / 64, (highest.y - lowest.y) / 32,
                                        (highest.z - lowest.z) / 48});
          program.set("sampleDistance", 0.018F);
          program.set("referenceDistance", 0.02F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          box.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
