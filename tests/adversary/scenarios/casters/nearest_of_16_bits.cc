// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario nearest_of_16_bits() {
  return {.sentence = "16 bits without interpolation; samples of exactly 777 are white.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  int stored = int(value * 65535.0 + 0.5);
  colour = stored == 777 ? vec4(1.0, 1.0, 1.0, 0.06) : texture(table, vec2(float(stored) / 1300.0, 0.5));)"),
                                               .grid = sampled(48,
                                                               [](float x, float y, float z) {
                                                                 return x > 0.6F && z > 0.5F
                                                                            ? 777.0F / 65535
                                                                            : waves(x, y, z) * 1300 / 65535;
                                                               }),
                                               .format = {.texel = Texel::unsigned16, .filter = GL_NEAREST}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
