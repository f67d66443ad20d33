// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario subroutine_changed() {
  return {.sentence = "Another subroutine, which tints by place, is chosen at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = at_version(430, over_caster(R"(
subroutine vec3 Look(vec3 colour, vec3 place);
subroutine(Look) vec3 as_it_is(vec3 colour, vec3 place) { return colour; }
subroutine(Look) vec3 by_place(vec3 colour, vec3 place) { return colour * place.zzx; }
subroutine uniform Look look;)",
                                                                 "  colour.rgb = look(colour.rgb, here);"))});
            return [&canvas, scene](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              const Camera camera = scene->camera(frame);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              scene->program.set("eye", camera.eye);
              set_blending(canvas.gl, scene->settings.blending);
              const GLuint chosen = canvas.gl.GetSubroutineIndex(scene->program.name(), GL_FRAGMENT_SHADER,
                                                                 frame < 10 ? "as_it_is" : "by_place");
              canvas.gl.UniformSubroutinesuiv(GL_FRAGMENT_SHADER, 1, &chosen);
              canvas.gl.Enable(GL_CULL_FACE);
              scene->vertices.draw(box_triangles());
            };
          }};
}

}  // namespace adversary::casters
