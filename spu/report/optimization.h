// SPDX-License-Identifier: Apache-2.0
// What is left out of frames because it cannot change the image, by name: the report counts each, and
// `--disable-optimization` has each done nevertheless, to see what it is worth and that the image stays.
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
  const char* unit;  ///< of what is counted, plural
  const char* what;  ///< is left out
  double tolerance;  ///< how far the image, its brightest colour 1, may be off: 0 is bit for bit
};

/// In the order of Optimization.
std::span<const OptimizationText> optimization_table();
const OptimizationText& text_of(Optimization optimization);

using OptimizationSet = std::bitset<optimization_count>;

/// Names with commas between, or "all", or "none"; nothing where a name is unknown.
std::optional<OptimizationSet> optimizations_in(std::string_view names);

/// All names, with commas between.
std::string optimization_names();

}  // namespace understudy::spu
