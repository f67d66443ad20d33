// SPDX-License-Identifier: Apache-2.0
#include "spu/report/optimization.h"

#include <algorithm>
#include <array>

namespace understudy::spu {
namespace {

/// Largest effect of another compositing order, early ray termination and rounding; the brightest colour is 1.
constexpr double of_other_sums = 4e-6, of_ended_rays = 5e-6, of_rounding = 1e-6;

constexpr std::array<OptimizationText, optimization_count> table{{
    {"empty-bricks", "samples", "in blocks of which the colours show nothing", of_ended_rays},
    {"hidden-samples", "samples", "behind what is opaque", of_ended_rays},
    {"dominated-samples", "samples", "of a maximum, where nothing larger is than what the ray has seen",
     of_rounding},
    {"footprints", "bytes between nodes", "of pixels that no sample has reached", of_other_sums},
    {"unchanged-images", "images", "that were asked for before and are still there", 0},
    {"unchanged-texels", "bytes of texels", "that the nodes have already", 0},
    {"known-colours", "probes", "of colours that are known", 0},
    {"absent-depth", "bytes of depth", "where no opaque geometry is", 0},
    {"unseen-depth", "runs of slices", "drawn for a depth that nobody looks at", 0},
}};

}  // namespace

std::span<const OptimizationText> optimization_table() {
  return table;
}

const OptimizationText& text_of(Optimization optimization) {
  return table[std::size_t(optimization)];
}

std::optional<OptimizationSet> optimizations_in(std::string_view names) {
  OptimizationSet found;
  if (names.empty() || names == "none") return found;
  if (names == "all") return found.set();
  for (bool more = true; more;) {
    const std::size_t comma = names.find(',');
    const std::string_view name = names.substr(0, comma);
    const auto row = std::find_if(table.begin(), table.end(),
                                  [&](const OptimizationText& text) { return name == text.name; });
    if (row == table.end()) return std::nullopt;
    found.set(std::size_t(row - table.begin()));
    more = comma != std::string_view::npos;
    if (more) names.remove_prefix(comma + 1);
  }
  return found;
}

std::string optimization_names() {
  std::string names;
  for (const OptimizationText& text : table) {
    if (!names.empty()) names += ", ";
    names += text.name;
  }
  return names;
}

}  // namespace understudy::spu
