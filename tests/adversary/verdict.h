// SPDX-License-Identifier: Apache-2.0
// What became of one scenario under Understudy.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/tile_bound.h"

namespace adversary {

struct Verdict {
  int frames = 0;
  int substituted = 0;
  std::vector<int> wrong_frames;
  int wrong_substituted = 0;  ///< of the wrong ones, those that were substituted
  TileScore worst;
  int worst_frame = 0;
  std::string
      other_fact;  ///< the first that OpenGL told the program (a query, an error), where bare it told another
};

/// Reads the folders bare/, exact/ and under/ and report.json in `folder`.
Verdict judge(const std::filesystem::path& folder, int frames);
/// Empty where the expectation is met; otherwise what is not.
std::string what_is_not_met(const Scenario& scenario, const Verdict& verdict);
/// One line: name, expectation, substituted, wrong, worst tile.
std::string line_about(const NamedScenario& scenario, const Verdict& verdict);

}  // namespace adversary
