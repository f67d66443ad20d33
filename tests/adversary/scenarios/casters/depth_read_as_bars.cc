// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario depth_read_as_bars() {
  return {
      .sentence =
          "The box writes depth in the window; from frame 7 on glReadPixels takes a row of it, and bars show "
          "how near the volume is.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(1.0, 0.5 - 0.5 * at.y, 0.1, 1.0); }
)");
        return [&canvas, opaque, scene = caster_scene(canvas)](int frame) {
          canvas.begin(0.1F, 0.12F, 0.2F);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_box(scene->camera(frame));
          canvas.gl.Disable(GL_DEPTH_TEST);
          if (frame < 7) return;
          std::vector<float> row(static_cast<std::size_t>(canvas.width()));
          canvas.gl.ReadPixels(0, canvas.height() / 2, canvas.width(), 1, GL_DEPTH_COMPONENT, GL_FLOAT,
                               row.data());
          std::vector<Vector> bars;
          constexpr int count = 16;
          for (int bar = 0; bar < count; ++bar) {
            const std::size_t middle = row.size() * static_cast<std::size_t>(2 * bar + 1) / (2 * count);
            const float away = 0.1F / (1 - 0.99F * row[middle]);
            const float left = -1 + 2 * static_cast<float>(bar) / count, right = left + 1.8F / count;
            const float top = -1 + 0.5F * std::max(0.0F, 3 - away);
            bars.insert(bars.end(), {{left, -1, 0},
                                     {right, -1, 0},
                                     {right, top, 0},
                                     {left, -1, 0},
                                     {right, top, 0},
                                     {left, top, 0}});
          }
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", identity);
          scene->vertices.draw(bars);
        };
      }};
}

}  // namespace adversary::casters
