// SPDX-License-Identifier: Apache-2.0
// Which exchange a node group uses, and the names that users give it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compositor/exchange/schedule.h"
#include "compositor/transport/pixel_width.h"

namespace understudy::compositor {

/// How the regions of a composited image reach the application: each rank that reaches the image buffer writes
/// its own there, or all send theirs to rank 0.
enum class Gather : std::uint8_t { direct, root };

/// Whether parts of an image are composited while others are still drawn; automatic: if that is faster.
enum class Overlap : std::uint8_t { automatic, on, off };

struct ExchangeSettings {
  std::optional<Algorithm> algorithm;  ///< null: the cheapest one for each image
  Layout layout = Layout::rgba32f;
  Gather gather = Gather::direct;
  Overlap overlap = Overlap::automatic;
  std::optional<bool> packed;  ///< whether pixels are sent packed; null: if that is faster (packing_pays())
};

/// Sets "auto", or an algorithm by its name_of(): "direct-send". Returns false, with `settings` unchanged, for
/// any other name.
bool set_algorithm(ExchangeSettings& settings, std::string_view name);
/// Sets "float", "half" or "byte". Otherwise as set_algorithm().
bool set_layout(ExchangeSettings& settings, std::string_view name);
/// Sets "direct" or "root". Otherwise as set_algorithm().
bool set_gather(ExchangeSettings& settings, std::string_view name);
/// Sets "auto", "on" or "off". Otherwise as set_algorithm().
bool set_overlap(ExchangeSettings& settings, std::string_view name);
/// As set_overlap().
bool set_packed(ExchangeSettings& settings, std::string_view name);

}  // namespace understudy::compositor
