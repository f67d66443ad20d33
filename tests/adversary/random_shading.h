// SPDX-License-Identifier: Apache-2.0
// GLSL that turns a sample into a colour, by chance: what viewers write between the fetch of a texel and its
// blending.
//
// A text is either a function of the sample alone (of tables, constants and uniforms that never change
// besides), or something else can reach its colours: the sample's place, the pixel, the face, a second fetch, a
// derivative, the loop's counter or a uniform that changes from frame to frame. Which of both is known from how
// the text was made.
#pragma once

#include <random>
#include <string>

namespace adversary {

enum class Dependence { sample_alone, other_things };

struct RandomShading {
  std::string declarations;  ///< before main()
  std::string body;          ///< after `value` and `colour` were declared; it ends by assigning `colour`
};

/// The names of what a body may read besides `value`, `colour` and its own uniforms.
struct ShadingPlace {
  std::string position;      ///< a vec3, the sample's texture coordinate
  std::string skip;          ///< the statement that leaves this sample out
  std::string counter = {};  ///< an int, which sample of the ray this is; empty for slices
};

/// Uniforms that the text reads: `level` and `curve[4]`, which the program sets once, and `moment`, which is 0
/// in the first frames and grows then.
RandomShading random_shading(std::mt19937& chance, Dependence dependence, const ShadingPlace& place);

}  // namespace adversary
