// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/random_scenario.h"

#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/random_shading.h"
#include "tests/adversary/slice_scene.h"

namespace adversary {
namespace {

bool casts_rays(unsigned seed) {
  return seed % 2 == 1;
}

Dependence dependence_of(unsigned seed) {
  return seed / 2 % 2 == 0 ? Dependence::sample_alone : Dependence::other_things;
}

/// Sets the uniforms of every program. `moment` is 0 until frame 3.
void set_uniforms(const GlslProgram& program, int frame) {
  program.use();
  program.set("level", 0.35F);
  for (int i = 0; i < 4; ++i)
    program.set("curve[" + std::to_string(i) + "]", 0.2F + 0.25F * static_cast<float>(i));
  program.set("moment", std::clamp(0.15F * static_cast<float>(frame - 3), 0.0F, 1.0F));
}

template <typename Scene>
DrawFrame drawn(std::shared_ptr<Scene> scene) {
  return [scene](int frame) {
    set_uniforms(scene->program, frame);
    scene->draw(frame);
  };
}

}  // namespace

std::string random_fragment_shader(unsigned seed) {
  std::mt19937 chance(seed);
  const ShadingPlace place = casts_rays(seed)
                                 ? ShadingPlace{.position = "here", .skip = "continue", .counter = "i"}
                                 : ShadingPlace{.position = "at", .skip = "discard"};
  const RandomShading shading = random_shading(chance, dependence_of(seed), place);
  return casts_rays(seed) ? over_caster(shading.declarations, shading.body)
                          : slice_fragment_shader(shading.declarations, shading.body);
}

NamedScenario random_scenario(unsigned seed) {
  const bool alone = dependence_of(seed) == Dependence::sample_alone;
  Scenario scenario{.sentence = alone ? "Colours of the sample alone, by chance."
                                      : "Colours of the sample and other things, by chance.",
                    .expectation = alone ? Expectation::must_be_substituted : Expectation::either};
  const std::string fragment = random_fragment_shader(seed);
  if (casts_rays(seed))
    scenario.start = [fragment](Canvas& canvas) { return drawn(caster_scene(canvas, {.fragment = fragment})); };
  else
    scenario.start = [fragment](Canvas& canvas) { return drawn(slice_scene(canvas, {.fragment = fragment})); };
  return {"random_" + std::to_string(seed), scenario};
}

}  // namespace adversary
