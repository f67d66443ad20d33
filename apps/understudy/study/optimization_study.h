// SPDX-License-Identifier: Apache-2.0
// Measures what each optimization saves: runs the bundled viewer under `understudy run` on a scene, both with
// all optimizations and with one of them disabled (`--disable-optimization`).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"

namespace understudy::launcher::study {

struct Saving {
  std::string item;
  std::string unit;
  std::string shown;           ///< options of the viewer and the run, in addition to the scene's
  std::uint64_t left_out = 0;  ///< skipped work, over all frames
  std::uint64_t all = 0;       ///< all work, skipped or done
  double ms = 0;               ///< median frame time
  double ms_without = 0;       ///< median frame time with the optimization disabled
  double difference = 0;       ///< greatest difference between the images, in float
  double tolerance = 0;
  std::string absent;  ///< why it could not be measured; empty: it was measured
};

/// Works in `folder`, which it creates and removes. Calls `progress` with the name of each optimization.
std::vector<Saving> savings_of(const Scene& scene, const std::filesystem::path& folder,
                               const std::function<void(const std::string& item)>& progress);

}  // namespace understudy::launcher::study
