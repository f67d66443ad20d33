// SPDX-License-Identifier: Apache-2.0
// What leaving out is worth: the bundled viewer under `understudy run` on a scene, once as usual and once with
// one item done nevertheless (`--disable-optimization`), item by item.
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
  std::string shown;           ///< options of the viewer and the run, beside the scene's
  std::uint64_t left_out = 0;  ///< over all frames
  std::uint64_t all = 0;       ///< of which
  double ms = 0;               ///< median of a frame
  double ms_without = 0;       ///< with the item done nevertheless
  double difference = 0;       ///< the greatest between the images, in float
  double tolerance = 0;
  std::string absent;  ///< why it could not be measured; empty: it was
};

/// Works in `folder`, which it makes and removes. `progress` hears of every item.
std::vector<Saving> savings_of(const Scene& scene, const std::filesystem::path& folder,
                               const std::function<void(const std::string& item)>& progress);

}  // namespace understudy::launcher::study
