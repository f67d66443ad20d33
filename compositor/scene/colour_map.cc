// SPDX-License-Identifier: Apache-2.0
#include "compositor/scene/colour_map.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace understudy::compositor {
namespace {

using Json = nlohmann::ordered_json;

/// Colours that are not multiplied by alpha, from 0 to 1; at constant distances from `low` to `high`.
struct Points {
  double low = 0;
  double high = 1;
  std::vector<volume::Rgba> colours;
};

volume::Rgba plain(const std::array<double, 4>& premultiplied) {
  const double alpha = premultiplied[3];
  volume::Rgba colour{};
  for (std::size_t k = 0; k < 3; ++k)
    colour[k] = alpha > 0 ? float(std::clamp(premultiplied[k] / alpha, 0.0, 1.0)) : 0.0F;
  colour[3] = float(std::clamp(alpha, 0.0, 1.0));
  return colour;
}

/// Gives invisible points the colour of the next visible one, or of the last: colours between two points are
/// not weighted by opacity.
void colour_invisible(std::vector<volume::Rgba>& colours) {
  const volume::Rgba* next = nullptr;
  const auto take = [&](volume::Rgba& colour) {
    if (colour[3] > 0)
      next = &colour;
    else if (next != nullptr)
      std::copy_n(next->begin(), 3, colour.begin());
  };
  std::for_each(colours.rbegin(), colours.rend(), take);
  // The last ones have no visible one behind them.
  next = nullptr;
  auto last = std::find_if(colours.rbegin(), colours.rend(), [](const auto& colour) { return colour[3] > 0; });
  std::for_each(last.base() - (last == colours.rend() ? 0 : 1), colours.end(), take);
}

Points points_of(const volume::TransferFunction& function) {
  Points points{function.low, function.high, {}};
  const std::size_t entries = function.entries.size();
  const std::size_t count = std::min(entries, std::size_t(max_colour_map_points));
  for (std::size_t i = 0; i < count; ++i)
    points.colours.push_back(plain(entry_at(function, double(i) * double(entries - 1) / double(count - 1))));
  return points;
}

/// Segments whose both ends have the same value.
Points points_of(const volume::PreIntegrationTable& table) {
  Points points{table.low, table.high, {}};
  const auto edge = std::size_t(table.edge);
  const std::size_t every = 1 + (edge - 1) / max_colour_map_points;
  for (std::size_t i = 0; i < edge; i += every) {
    const volume::Rgba& entry = table.entries[i * edge + i];
    const double by = table.multiply_by_alpha ? double(entry[3]) : 1;
    points.colours.push_back(
        plain({by * double(entry[0]), by * double(entry[1]), by * double(entry[2]), double(entry[3])}));
    points.high = table.low + double(i) / double(edge - 1) * (double(table.high) - double(table.low));
  }
  return points;
}

}  // namespace

std::optional<std::string> paraview_colour_map(const volume::Classification& classification,
                                               volume::TexelType type) {
  Points points;
  if (const auto* function = std::get_if<volume::TransferFunction>(&classification))
    points = points_of(*function);
  else if (const auto* table = std::get_if<volume::PreIntegrationTable>(&classification))
    points = points_of(*table);
  else
    return std::nullopt;
  colour_invisible(points.colours);
  Json colours = Json::array();
  Json opacities = Json::array();
  for (std::size_t i = 0; i < points.colours.size(); ++i) {
    const double share = double(i) / double(points.colours.size() - 1);
    const double value = (points.low + share * (points.high - points.low)) * volume::largest_texel(type);
    const volume::Rgba& colour = points.colours[i];
    for (const double number : {value, double(colour[0]), double(colour[1]), double(colour[2])})
      colours.push_back(number);
    // Midpoint and sharpness: linear between points.
    for (const double number : {value, double(colour[3]), 0.5, 0.0}) opacities.push_back(number);
  }
  const Json map = Json::array({{{"Name", "Understudy"},
                                 {"ColorSpace", "RGB"},
                                 {"RGBPoints", std::move(colours)},
                                 {"Points", std::move(opacities)}}});
  return map.dump() + "\n";
}

}  // namespace understudy::compositor
