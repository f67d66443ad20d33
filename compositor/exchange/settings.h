// SPDX-License-Identifier: Apache-2.0
// Which exchange a node group uses, and the names that users give it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compositor/exchange/schedule.h"
#include "compositor/transport/pixel_width.h"

namespace understudy::compositor {

/// How the parts of a composited image come to the application: each rank that reaches the application's
/// memory writes its own there, or all send theirs to rank 0.
enum class Gather : std::uint8_t { direct, root };

/// Whether parts of an image are composited while others are still drawn; automatic: where that is faster.
enum class Overlap : std::uint8_t { automatic, on, off };

struct ExchangeSettings {
  std::optional<Algorithm> algorithm;  ///< none: for each image the one that costs least
  Layout layout = Layout::rgba32f;
  Gather gather = Gather::direct;
  Overlap overlap = Overlap::automatic;
  std::optional<bool> packed;  ///< pixels travel packed; none: where that is faster (packing_pays())
};

/// "auto", or an algorithm's name as in name_of(): "direct-send". False, with `settings` unchanged, for any
/// other.
bool set_algorithm(ExchangeSettings& settings, std::string_view name);
/// "float", "half" or "byte". False, with `settings` unchanged, for any other.
bool set_layout(ExchangeSettings& settings, std::string_view name);
/// "direct" or "root". False, with `settings` unchanged, for any other.
bool set_gather(ExchangeSettings& settings, std::string_view name);
/// "auto", "on" or "off". False, with `settings` unchanged, for any other.
bool set_overlap(ExchangeSettings& settings, std::string_view name);
/// Likewise.
bool set_packed(ExchangeSettings& settings, std::string_view name);

}  // namespace understudy::compositor
