// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_ambient_taken_away() {
  return {
      .sentence =
          "Light from the eye by a uniform of ambient, diffuse, specular parts and exponent; the ambient part "
          "is 0 from frame 14 to frame 23.",
      .expectation = Expectation::either,
      .key_frames = {14, 24},
      .start = [](Canvas& canvas) -> DrawFrame {
        // A pear with a core, and five seeds around it.
        const Field field = [](float x, float y, float z) {
          const float u = x - 0.5F, v = y - 0.45F, w = z - 0.5F;
          const float width = 11 + 14 * y * y;
          float rest = 1 - 0.5F * std::exp(-width * (u * u + w * w) - 9 * v * v);
          for (int i = 0; i < 5; ++i) {
            const float angle = 1.2566F * static_cast<float>(i);
            const float a = u - 0.19F * std::cos(angle), b = v + 0.05F, c = w - 0.19F * std::sin(angle);
            rest *= 1 - 0.75F * std::exp(-240 * (a * a + c * c) - 110 * b * b);
          }
          return 1 - rest;
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float peel = std::exp(-std::pow((at - 0.2F) / 0.06F, 2.0F));
          const float seed = at > 0.5F ? 1 - std::exp(-std::pow((at - 0.5F) / 0.15F, 2.0F)) : 0;
          table.push_back({static_cast<std::uint8_t>(at < 0.4F ? 150 : 130),
                           static_cast<std::uint8_t>(at < 0.4F ? 190 : 80),
                           static_cast<std::uint8_t>(at < 0.4F ? 70 : 50),
                           static_cast<std::uint8_t>(std::lround(20 * peel + 75 * seed))});
        }
        auto scene = caster_scene(canvas, {.fragment = R"(#version 330
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform vec4 lighting; /* x ambient, y diffuse, z specular, w exponent */
in vec3 at;
out vec4 shown;

#define SAMPLE(p) texture(volume, (p)).r
#define EPS 0.015625

vec3 shade(vec3 albedo, vec3 p, vec3 viewDir)
{
    vec3 n;
    n.x = SAMPLE(p + vec3(EPS, 0, 0)) - SAMPLE(p - vec3(EPS, 0, 0));
    n.y = SAMPLE(p + vec3(0, EPS, 0)) - SAMPLE(p - vec3(0, EPS, 0));
    n.z = SAMPLE(p + vec3(0, 0, EPS)) - SAMPLE(p - vec3(0, 0, EPS));
    float l = length(n);
    n = l > 1e-5 ? n / l : vec3(0.0);
    float cosine = abs(dot(n, viewDir));
    return albedo * lighting.x + albedo * lighting.y * cosine + lighting.z * pow(cosine, lighting.w);
}

void main()
{
    vec3 viewDir = normalize(at - eye);
    vec3 toSides = (step(0.0, viewDir) - at) / viewDir;
    float tmax = min(toSides.x, min(toSides.y, toSides.z));
    vec4 dst = vec4(0.0);
    float t = 0.0;
    do {
        vec3 p = at + t * viewDir;
        vec4 src = texture(table, vec2(SAMPLE(p), 0.5));
        if (src.a > 0.0) {
            src.rgb = shade(src.rgb, p, viewDir) * src.a;
            dst += src * (1.0 - dst.a);
        }
        t += step_length;
    } while (t <= tmax);
    shown = dst;
}
)",
                                           .grid = sampled(64, field),
                                           .table = table,
                                           .step_length = 0.018F,
                                           .orbit = {.azimuth = 75, .elevation = 15}});
        return [scene](int frame) {
          scene->program.use();
          const float ambient = frame >= 14 && frame < 24 ? 0 : 0.35F;
          scene->canvas.gl.Uniform4f(scene->program.location("lighting"), ambient, 0.5F, 0.2F, 12);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
