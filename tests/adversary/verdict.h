// SPDX-License-Identifier: Apache-2.0
// What became of one scenario under Understudy.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/tile_bound.h"

namespace adversary {

struct Verdict {
  int frames = 0;
  int substituted = 0;
  int compared = 0;  ///< whole images
  std::vector<int> wrong_frames;
  int wrong_substituted = 0;  ///< of the wrong ones, those that were substituted
  TileScore worst;
  int worst_frame = 0;
  std::string
      other_fact;  ///< the first that OpenGL told the program (a query, an error), where bare it told another
};

/// Reads the folders bare/, exact/ and under/ and report.json in `folder`. Without exact/ images must be
/// bare/'s: what is right then is right with it, too, because the range from one to the other begins there.
Verdict judge(const std::filesystem::path& folder, int frames);
/// The same, having `draw_exact` make exact/ only where a frame seems wrong without it, or where images are
/// kept.
Verdict judge_drawing_exactly_where_needed(const std::filesystem::path& folder, int frames,
                                           const std::function<void()>& draw_exact);
/// Whether images are to stay, for adversary_calibrate: the environment has ADVERSARY_KEEP_IMAGES.
bool keeps_images();
/// Empty where the expectation is met; otherwise what is not.
std::string what_is_not_met(const Scenario& scenario, const Verdict& verdict);
/// One line: name, expectation, substituted, wrong, worst tile.
std::string line_about(const NamedScenario& scenario, const Verdict& verdict);

}  // namespace adversary
