// SPDX-License-Identifier: Apache-2.0
// Scenarios by chance: a viewer of slices or rays whose shading was made by random_shading.h.
#pragma once

#include "tests/adversary/scenario.h"

namespace adversary {

/// The same for the same seed, on every machine. Even seeds draw slices, odd ones cast rays; of four seeds, two
/// have colours that depend on the sample alone, and must be substituted. The name is `random_SEED`.
NamedScenario random_scenario(unsigned seed);

/// The fragment shader of that scenario.
std::string random_fragment_shader(unsigned seed);

}  // namespace adversary
