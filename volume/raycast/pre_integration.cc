// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/pre_integration.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "volume/raycast/pre_integration_lookup.h"

namespace understudy::volume {

namespace {

using Colour = std::array<double, 4>;  // premultiplied

Colour colour_over(const Colour& front, const Colour& back) {
  const double room = 1 - front[3];
  return {front[0] + room * back[0], front[1] + room * back[1], front[2] + room * back[2],
          front[3] + room * back[3]};
}

Colour colour_between(const Colour& a, const Colour& b, double s) {
  Colour mixed;
  for (std::size_t k = 0; k < 4; ++k) mixed[k] = a[k] + s * (b[k] - a[k]);
  return mixed;
}

/// Clamps an opacity below 1, so that its optical depth is finite.
double believed(double opacity) {
  return std::clamp(opacity, 0.0, 1 - std::numeric_limits<double>::epsilon() / 2);
}

/// The mean optical depth of one step whose opacity varies linearly from a to b.
double mean_depth(double a, double b) {
  a = believed(a);
  b = believed(b);
  if (std::abs(b - a) < 1e-5) return -std::log1p(-(a + b) / 2);
  const auto integral = [](double opacity) { return (1 - opacity) * std::log1p(-opacity) + opacity; };
  return (integral(b) - integral(a)) / (b - a);
}

/// Premultiplied colour of a layer with opacity `opacity`, in a medium of which one step shows `colour`. `way`
/// is the layer's length in steps, used where the medium is transparent.
Colour layer(const Colour& colour, double opacity, double way) {
  constexpr double clear = 1e-12;
  Colour seen{0, 0, 0, opacity};
  for (std::size_t k = 0; k < 3; ++k)
    seen[k] = colour[3] > clear ? colour[k] / std::min(colour[3], 1.0) * opacity : colour[k] * way;
  return seen;
}

/// Colour of a segment of `length` steps over which the entries vary linearly from `front` to `back`, as
/// `parts` parts of constant colour.
Colour piece(const Colour& front, const Colour& back, double length, int parts) {
  Colour sum{};
  for (int part = 0; part < parts; ++part) {
    const Colour from = colour_between(front, back, double(part) / parts),
                 to = colour_between(front, back, (part + 1.0) / parts);
    const Colour middle = colour_between(from, to, 0.5);
    const double way = length / parts;
    sum = colour_over(sum, layer(middle, -std::expm1(-way * mean_depth(from[3], to[3])), way));
  }
  return sum;
}

/// Calls `segment` with front, back and colour of all segments whose back lies at a later entry than their
/// front, from several threads.
template <typename Segment>
void rising_segments(const std::vector<Colour>& entries, Segment segment) {
  const std::size_t pieces = entries.size() - 1;
  std::vector<Colour> middles(pieces);
  std::vector<double> depths(pieces);
  for (std::size_t i = 0; i < pieces; ++i) {
    middles[i] = colour_between(entries[i], entries[i + 1], 0.5);
    depths[i] = mean_depth(entries[i][3], entries[i + 1][3]);
  }
  tbb::parallel_for(std::size_t(1), pieces + 1, [&](std::size_t count) {
    std::vector<Colour> piece_at(pieces), up_to(pieces), from(pieces);
    // Within groups of `count` pieces: composites from the group's start up to each, and from each to its end.
    const int parts = count <= 2 ? 8 : count <= 8 ? 2 : 1;
    const double way = 1 / double(count);
    for (std::size_t i = 0; i < pieces; ++i)
      piece_at[i] = parts == 1 ? layer(middles[i], -std::expm1(-way * depths[i]), way)
                               : piece(entries[i], entries[i + 1], way, parts);
    for (std::size_t i = 0; i < pieces; ++i)
      up_to[i] = i % count == 0 ? piece_at[i] : colour_over(up_to[i - 1], piece_at[i]);
    for (std::size_t i = pieces; i-- > 0;)
      from[i] = i % count == count - 1 || i + 1 == pieces ? piece_at[i] : colour_over(piece_at[i], from[i + 1]);
    for (std::size_t front = 0; front + count <= pieces; ++front) {
      const std::size_t last = front + count - 1;
      segment(front, front + count, front % count == 0 ? up_to[last] : colour_over(from[front], up_to[last]));
    }
  });
}

/// The largest second difference of the entries of `function`, over all components.
double sharpest_bend(const TransferFunction& function) {
  double sharpest = 0;
  for (std::size_t i = 1; i + 1 < function.entries.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      sharpest =
          std::max(sharpest, std::abs(double(function.entries[i - 1][k]) - 2 * double(function.entries[i][k]) +
                                      double(function.entries[i + 1][k])));
  return sharpest;
}

}  // namespace

PreIntegrationTable pre_integrated(const TransferFunction& function) {
  constexpr std::size_t least_pieces = 255, most_pieces = std::size_t(max_pre_integration_edge) - 1;
  constexpr double tolerance = 1e-3;
  const std::size_t given = function.entries.size() - 1;
  std::size_t pieces = most_pieces;
  if (given < most_pieces) {
    const std::size_t for_edge = (least_pieces + given - 1) / given;
    const auto for_bends = std::size_t(std::min(std::ceil(sharpest_bend(function) / (8 * tolerance)), 1e4));
    pieces = given * std::clamp(std::max(for_edge, for_bends), std::size_t(1), most_pieces / given);
  }
  std::vector<Colour> entries;
  for (std::size_t i = 0; i <= pieces; ++i) {
    const double place = double(i) * double(given) / double(pieces);
    const auto below = std::min(std::size_t(place), given - 1);
    const auto colour = [&](std::size_t entry) {
      const Rgba& e = function.entries[entry];
      return Colour{e[0], e[1], e[2], e[3]};
    };
    entries.push_back(colour_between(colour(below), colour(below + 1), place - double(below)));
  }

  PreIntegrationTable table;
  table.low = function.low;
  table.high = function.high;
  table.edge = int(entries.size());
  table.multiply_by_alpha = false;
  table.entries.resize(entries.size() * entries.size());
  const auto put = [&](std::size_t front, std::size_t back, const Colour& c) {
    table.entries[back * entries.size() + front] = {float(c[0]), float(c[1]), float(c[2]), float(c[3])};
  };
  for (std::size_t i = 0; i < entries.size(); ++i) put(i, i, entries[i]);
  rising_segments(entries, put);
  std::reverse(entries.begin(), entries.end());
  rising_segments(entries, [&](std::size_t front, std::size_t back, const Colour& c) {
    put(pieces - front, pieces - back, c);
  });
  return table;
}

}  // namespace understudy::volume
