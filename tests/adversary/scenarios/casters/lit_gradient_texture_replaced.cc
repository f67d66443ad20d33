// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_gradient_texture_replaced() {
  return {
      .sentence =
          "Light from the eye by normals in a second 3-D texture: those of the volume itself, and from frame "
          "15 on those of a smoother one with bumps of its own.",
      .expectation = Expectation::either,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        // Three pillars of two materials under a dome.
        const Field field = [](float x, float y, float z) {
          float rest = 1;
          for (int i = 0; i < 3; ++i) {
            const float angle = 2.0944F * static_cast<float>(i) + 0.4F;
            const float a = x - 0.5F - 0.2F * std::cos(angle), c = z - 0.5F - 0.2F * std::sin(angle);
            const float waist = 110 + 60 * std::sin(14 * y);
            rest *= 1 - (0.6F + 0.15F * static_cast<float>(i)) *
                            std::exp(-waist * (a * a + c * c) - 30 * std::pow(y - 0.38F, 4.0F));
          }
          const float radius = std::hypot(x - 0.5F, 0.9F * (y - 0.35F), z - 0.5F) - 0.4F;
          const float dome = y > 0.3F ? 0.32F * std::exp(-250 * radius * radius) *
                                            (1 - std::exp(-90 * (y - 0.3F) * (y - 0.3F)))
                                      : 0;
          return 1 - rest * (1 - dome);
        };
        const Field bumps = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.45F, c = z - 0.5F;
          const float bump = std::sin(24 * x) * std::sin(24 * y) * std::sin(24 * z);
          return std::exp(-6 * (a * a + b * b + c * c)) + 0.02F * bump;
        };
        // Outward and of unit length, as colours.
        const auto normals_of = [](const Field& of) {
          constexpr int edge = 56;
          constexpr float d = 1.0F / edge;
          Grid normals{edge, edge, edge, 4, {}};
          for (int k = 0; k < edge; ++k)
            for (int j = 0; j < edge; ++j)
              for (int i = 0; i < edge; ++i) {
                const float x = d * (static_cast<float>(i) + 0.5F), y = d * (static_cast<float>(j) + 0.5F),
                            z = d * (static_cast<float>(k) + 0.5F);
                const Vector out{of(x - d, y, z) - of(x + d, y, z), of(x, y - d, z) - of(x, y + d, z),
                                 of(x, y, z - d) - of(x, y, z + d)};
                const float size = std::sqrt(dot(out, out)) + 1e-9F;
                for (const float part : {out.x, out.y, out.z})
                  normals.values.push_back(0.5F + 0.5F * part / size);
                normals.values.push_back(1);
              }
          return normals;
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float roof = std::exp(-std::pow((at - 0.2F) / 0.06F, 2.0F));
          const float marble = std::exp(-std::pow((at - 0.55F) / 0.12F, 2.0F));
          const float bronze = std::exp(-std::pow((at - 0.88F) / 0.09F, 2.0F));
          const float all = roof + marble + bronze + 1e-9F;
          table.push_back({static_cast<std::uint8_t>((70 * roof + 200 * marble + 180 * bronze) / all),
                           static_cast<std::uint8_t>((150 * roof + 195 * marble + 120 * bronze) / all),
                           static_cast<std::uint8_t>((160 * roof + 185 * marble + 40 * bronze) / all),
                           static_cast<std::uint8_t>(std::lround(14 * roof + 45 * marble + 80 * bronze))});
        }
        auto scene =
            caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler3D normals;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 rd = normalize(at - eye);
  vec3 ends = (step(0.0, rd) - at) / rd;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec3 p = at + float(i) * step_length * rd;
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    if (c.a > 0.0) {
      vec3 n = normalize(2.0 * texture(normals, p).xyz - 1.0 + vec3(1e-5));
      float nl = max(dot(n, -rd), 0.0);
      c.rgb = c.rgb * (0.25 + 0.55 * nl) + 0.2 * pow(nl, 24.0);
      sum += (1.0 - sum.a) * vec4(c.rgb * c.a, c.a);
    }
  }
  shown = sum;
}
)",
                                  .grid = sampled(56, field),
                                  .table = table,
                                  .step_length = 0.02F,
                                  .orbit = {.azimuth = 330, .elevation = 22, .degrees_each_frame = 2}});
        constexpr VolumeFormat as_colours{.shown = Shown::colour};
        upload_volume(canvas, 2, normals_of(field), as_colours);
        return [scene, bumps, normals_of, as_colours](int frame) {
          scene->program.use();
          scene->program.set("normals", 2);
          if (frame == 15) {
            scene->canvas.gl.ActiveTexture(GL_TEXTURE2);
            replace_texels(scene->canvas, normals_of(bumps), as_colours);
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
