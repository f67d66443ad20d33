#include "volume/transfer_knots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace understudy::volume {

namespace {

/// So fine that a step between two entries is narrower than any value of 8 bits.
constexpr int table_entries = 4096;

using Knot = TransferKnots::Knot;

struct Named {
  std::string_view name;
  std::vector<Knot> knots;
};

const std::array<Named, 5>& named() {
  static const std::array<Named, 5> all{{
      {"grey", {{0, {0, 0, 0}, 0}, {1, {1, 1, 1}, 0.1}}},
      // The case as a veil, the denser parts within it in colour.
      {"engine",
       {{0, {0.5, 0.5, 0.55}, 0},
        {0.28, {0.5, 0.5, 0.55}, 0},
        {0.38, {0.65, 0.68, 0.72}, 0.02},
        {0.55, {0.6, 0.64, 0.7}, 0.03},
        {0.68, {0.9, 0.45, 0.15}, 0.3},
        {1, {1, 0.85, 0.6}, 0.7}}},
      // Air is nothing, soft tissue a skin, bone is solid.
      {"ct",
       {{0, {0.8, 0.55, 0.45}, 0},
        {0.22, {0.8, 0.55, 0.45}, 0},
        {0.3, {0.85, 0.6, 0.5}, 0.02},
        {0.42, {0.85, 0.55, 0.45}, 0.015},
        {0.5, {0.95, 0.9, 0.8}, 0.25},
        {1, {1, 1, 0.95}, 0.8}}},
      {"vessels",
       {{0, {0.5, 0, 0}, 0},
        {0.12, {0.6, 0.05, 0.05}, 0},
        {0.35, {0.9, 0.2, 0.1}, 0.3},
        {1, {1, 0.9, 0.7}, 0.9}}},
      {"rainbow",
       {{0, {0, 0, 1}, 0},
        {0.25, {0, 0.8, 1}, 0.01},
        {0.5, {0.1, 0.9, 0.2}, 0.03},
        {0.75, {1, 0.9, 0}, 0.08},
        {1, {1, 0.1, 0}, 0.2}}},
  }};
  return all;
}

bool in_unit_range(double value) {
  return value >= 0 && value <= 1;  // false for NaN
}

Knot at(const std::vector<Knot>& knots, double place) {
  // The last knot that is not behind `place`: at a step the one behind it.
  const auto next = std::ranges::upper_bound(knots, place, {}, &Knot::at);
  if (next == knots.begin()) return knots.front();
  if (next == knots.end()) return knots.back();
  const Knot &a = *(next - 1), &b = *next;
  const double share = (place - a.at) / (b.at - a.at);
  Knot between{place, {}, a.opacity + share * (b.opacity - a.opacity)};
  for (std::size_t k = 0; k < 3; ++k) between.colour[k] = a.colour[k] + share * (b.colour[k] - a.colour[k]);
  return between;
}

}  // namespace

void check(const TransferKnots& knots) {
  const auto fail = [](std::size_t knot, const std::string& what) {
    throw std::invalid_argument(fmt::format("knot {}: {}", knot + 1, what));
  };
  if (knots.knots.size() < 2)
    throw std::invalid_argument(fmt::format(
        "{} knots are too few for a transfer function; give two at least, as in [{{\"at\": 0, \"colour\": "
        "[0, 0, 0], \"opacity\": 0}}, {{\"at\": 1, \"colour\": [1, 1, 1], \"opacity\": 0.1}}]",
        knots.knots.size()));
  for (std::size_t i = 0; i < knots.knots.size(); ++i) {
    const Knot& knot = knots.knots[i];
    if (!std::isfinite(knot.at)) fail(i, "its place is not a number; give the value that it stands at");
    if (!in_unit_range(knot.opacity))
      fail(i, fmt::format("its opacity is {}, not 0 to 1; give that of one voxel's length", knot.opacity));
    for (const double component : knot.colour)
      if (!in_unit_range(component))
        fail(i, fmt::format("its colour has a component of {}, not 0 to 1", component));
    if (i > 0 && knot.at < knots.knots[i - 1].at)
      fail(i, fmt::format("it stands at {}, before the one ahead of it at {}; sort them", knot.at,
                          knots.knots[i - 1].at));
  }
  if (knots.knots.front().at == knots.knots.back().at)
    throw std::invalid_argument(
        fmt::format("all knots stand at {}; give them different places", knots.knots.front().at));
}

std::vector<std::string> built_in_knot_names() {
  std::vector<std::string> names;
  for (const Named& row : named()) names.emplace_back(row.name);
  return names;
}

std::string built_in_knots() {
  std::string names;
  for (const std::string& name : built_in_knot_names()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

TransferKnots knots_named(const std::string& name) {
  const auto* const found = std::ranges::find(named(), name, &Named::name);
  if (found == named().end())
    throw std::invalid_argument(
        fmt::format("there is no transfer function '{}'; name a file, or one of {}", name, built_in_knots()));
  return {false, found->knots};
}

TransferKnots spanning(const TransferKnots& knots, double low, double high) {
  check(knots);
  TransferKnots spread = knots;
  const double first = knots.of_values ? low : 0, last = knots.of_values ? high : 1;
  if (Knot knot = knots.knots.front(); first < knot.at) {
    knot.at = first;
    spread.knots.insert(spread.knots.begin(), knot);
  }
  if (Knot knot = knots.knots.back(); last > knot.at) {
    knot.at = last;
    spread.knots.push_back(knot);
  }
  return spread;
}

TransferFunction sampled(const TransferKnots& knots, double low, double high, double step) {
  check(knots);
  if (!(step > 0 && std::isfinite(step)))
    throw std::invalid_argument(fmt::format("a step of {} voxels leads nowhere; give a positive one", step));
  const double scale = knots.of_values ? 1.0 : high - low, offset = knots.of_values ? 0.0 : low;
  const double first = knots.knots.front().at, last = knots.knots.back().at;
  TransferFunction table;
  table.low = float(offset + scale * first);
  table.high = float(offset + scale * last);
  table.entries.reserve(table_entries);
  for (int i = 0; i < table_entries; ++i) {
    const Knot knot = at(knots.knots, first + (last - first) * i / (table_entries - 1));
    const double alpha = knot.opacity >= 1 ? 1.0 : -std::expm1(step * std::log1p(-knot.opacity));
    Rgba& entry = table.entries.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) entry[k] = float(knot.colour[k] * alpha);
    entry[3] = float(alpha);
  }
  return table;
}

}  // namespace understudy::volume
