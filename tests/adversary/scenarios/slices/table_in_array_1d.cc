// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario table_in_array_1d() {
  return {.sentence = "The table is a layer of a 1-D array texture, edited at frame 12.",
          .expectation = Expectation::either,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            constexpr TableKind kind = TableKind::array_1d;
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(
                                                  table_declarations(kind), "  colour = looked_up(value);")});
            const OddTable table(canvas, kind, scene->program, soft_colours());
            return [scene, table](int frame) {
              if (frame == 12) table.edit(other_colours());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
