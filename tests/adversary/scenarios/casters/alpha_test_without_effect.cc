// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario alpha_test_without_effect() {
  return {
      .sentence =
          "A compatibility profile. An alpha test lets all rays pass, and from frame 10 on it discards those "
          "of opacity 0, which would change nothing.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(), .blending = Blending::over});
        canvas.gl.Enable(GL_ALPHA_TEST);
        return [&canvas, scene](int frame) {
          canvas.gl.AlphaFunc(frame < 10 ? GL_ALWAYS : GL_GREATER, frame < 10 ? 0.7F : 0.0F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
