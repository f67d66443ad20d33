// SPDX-License-Identifier: Apache-2.0
// One small program that draws a volume, and what is expected of Understudy under it, said before it is run.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/adversary/canvas.h"

namespace adversary {

enum class Expectation {
  must_be_substituted,  ///< a plain volume, of a kind that README.md lists as replaced
  must_be_left,  ///< its drawing has effects beside the image, so it may be neither repeated nor replaced
  either         ///< replaced or not, what is shown must be right
};

/// Draws the frame of this number, from 0, and ends without swapping.
using DrawFrame = std::function<void(int frame)>;

const char* text_of(Expectation expectation);

struct Scenario {
  std::string sentence;
  Expectation expectation = Expectation::either;
  /// Frames at which something changes that the program tells OpenGL (a uniform, a texture, a program), and
  /// that a substitute must therefore have noticed before the frame is shown.
  std::vector<int> key_frames = {};
  Profile profile = Profile::core;
  /// So many images at most are compared whole: where nothing but the camera changes, the viewer would be
  /// faster without Understudy if more were. Empty: any number.
  std::optional<int> most_compared = {};
  /// Called once, with the context current. What it creates lives as long as the context.
  std::function<DrawFrame(Canvas&)> start;
};

struct NamedScenario {
  std::string name;
  Scenario scenario;
};

/// In the order of the folders' files; names are `slices_FILE` and `casters_FILE`.
std::vector<NamedScenario> all_scenarios();

}  // namespace adversary
