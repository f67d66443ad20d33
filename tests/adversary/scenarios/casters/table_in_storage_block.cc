// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario table_in_storage_block() {
  return {.sentence = "The table is a shader storage block, edited at frame 12.",
          .expectation = Expectation::either,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            constexpr TableKind kind = TableKind::storage_block;
            auto scene = caster_scene(
                canvas, {.fragment = at_version(
                             430, over_caster(table_declarations(kind), "    colour = looked_up(value);"))});
            const OddTable table(canvas, kind, scene->program, soft_colours());
            return [scene, table](int frame) {
              if (frame == 12) table.edit(other_colours());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
