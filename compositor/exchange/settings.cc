// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/settings.h"

#include <array>
#include <utility>

namespace understudy::compositor {

bool set_algorithm(ExchangeSettings& settings, std::string_view name) {
  if (name == "auto") {
    settings.algorithm.reset();
    return true;
  }
  for (std::size_t i = 0; i < algorithm_count; ++i) {
    if (name_of(Algorithm(i)) != name) continue;
    settings.algorithm = Algorithm(i);
    return true;
  }
  return false;
}

bool set_layout(ExchangeSettings& settings, std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Layout>, 3> names{
      {{"float", Layout::rgba32f}, {"half", Layout::rgba16f}, {"byte", Layout::rgba8}}};
  for (const auto& [known, layout] : names) {
    if (known != name) continue;
    settings.layout = layout;
    return true;
  }
  return false;
}

bool set_gather(ExchangeSettings& settings, std::string_view name) {
  if (name != "direct" && name != "root") return false;
  settings.gather = name == "direct" ? Gather::direct : Gather::root;
  return true;
}

bool set_overlap(ExchangeSettings& settings, std::string_view name) {
  if (name != "auto" && name != "on" && name != "off") return false;
  settings.overlap = name == "auto" ? Overlap::automatic : name == "on" ? Overlap::on : Overlap::off;
  return true;
}

bool set_packed(ExchangeSettings& settings, std::string_view name) {
  if (name != "auto" && name != "on" && name != "off") return false;
  settings.packed.reset();
  if (name != "auto") settings.packed = name == "on";
  return true;
}

}  // namespace understudy::compositor
