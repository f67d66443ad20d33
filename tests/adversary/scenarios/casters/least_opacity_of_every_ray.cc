// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario least_opacity_of_every_ray() {
  return {
      .sentence =
          "Many faint samples on every ray, and an opacity of 0.001 on rays that see nothing, as vispy has it.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<Colour> faint;
        faint.reserve(64);
        for (int i = 0; i < 64; ++i) {
          faint.push_back({static_cast<std::uint8_t>(80 + 2 * i), static_cast<std::uint8_t>(200 - 2 * i), 120,
                           static_cast<std::uint8_t>(i < 12 ? 0 : 1 + i / 8)});
        }
        return [scene = caster_scene(canvas,
                                     {.fragment = caster_fragment_shader({.before = "  vec4 sum = vec4(0.0);",
                                                                          .each = R"(
    vec4 colour = texture(table, vec2(value, 0.5));
    float weight = (1.0 - sum.a) * colour.a;
    sum = vec4(sum.rgb + weight * colour.rgb, max(sum.a + weight, 0.001));)",
                                                                          .after = "  shown = sum;"}),
                                      .table = faint,
                                      .step_length = 0.004F})](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
