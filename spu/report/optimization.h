// SPDX-License-Identifier: Apache-2.0
// The names of the optimizations, which skip work that cannot change the image. The report counts what each
// skips, and `--disable-optimization` disables them, to measure what an optimization gains and to check that
// the image is the same.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace understudy::spu {

enum class Optimization : std::uint8_t {
  empty_bricks,
  hidden_samples,
  dominated_samples,
  footprints,
  unchanged_images,
  unchanged_texels,
  known_colours,
  absent_depth,
  unseen_depth,
};
constexpr std::size_t optimization_count = 9;

struct OptimizationText {
  const char* name;
  const char* unit;  ///< what is counted, in the plural
  const char* what;  ///< describes the skipped work
  double tolerance;  ///< largest difference of the image, relative to its brightest colour: 0 is exact
};

/// In the order of Optimization.
std::span<const OptimizationText> optimization_table();
const OptimizationText& text_of(Optimization optimization);

using OptimizationSet = std::bitset<optimization_count>;

/// Parses comma-separated names, "all" or "none"; returns nothing if a name is unknown.
std::optional<OptimizationSet> optimizations_in(std::string_view names);

/// All names, separated by commas.
std::string optimization_names();

}  // namespace understudy::spu
