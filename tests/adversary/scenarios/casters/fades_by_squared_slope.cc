// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fades_by_squared_slope() {
  return {.sentence =
              "Opacity by a second table as in other viewers, but looked up by the square of the gradient's "
              "length, which saves a root.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform sampler2D steepness;
vec3 slope(vec3 p) {
  const float d = 1.0 / 44.0;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  vec3 g = slope(here);
  colour.a *= texture(steepness, vec2(clamp(25.0 * dot(g, g), 0.0, 1.0), 0.5)).r;)"),
                                               .grid = sampled(44, waves),
                                               .format = {.texel = Texel::unsigned16},
                                               .orbit = {.azimuth = 220, .elevation = 15}});
            std::vector<Colour> steepness;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float peak = std::max(0.0F, 1 - std::abs(at - 0.45F) / 0.4F);
              const auto factor = static_cast<std::uint8_t>(std::lround(255 * peak));
              steepness.push_back({factor, factor, factor, 255});
            }
            upload_table_2d(canvas, 2, steepness);
            scene->program.use();
            scene->program.set("steepness", 2);
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
