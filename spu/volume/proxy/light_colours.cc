// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/light_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace understudy::spu {
namespace {

constexpr std::size_t channels = 3;

/// Base colours are distinguished if their deviation exceeds this fraction of their mean.
constexpr double least_spread = 0.05;

/// y = offset + factor x, by least squares.
struct Line {
  double factor = 0;
  double offset = 0;
};

/// Means, variance and covariance of pairs.
class PairSums {
 public:
  void add(double x, double y) {
    ++n_;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
  }
  double mean_x() const { return x_ / n_; }
  double mean_y() const { return y_ / n_; }
  double square() const { return std::max(0.0, xx_ / n_ - mean_x() * mean_x()); }
  double product() const { return xy_ / n_ - mean_x() * mean_y(); }
  double deviation() const { return std::sqrt(square()); }

 private:
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

/// What light at one angle makes of the base colours, channel by channel: a multiple, and an added part.
struct SeenLight {
  Tint factor{};
  Tint added{};
};

/// Sums of what is seen against the base colour, channel by channel.
std::array<PairSums, channels> sums_by_channel(const std::vector<Tint>& base, const std::vector<Tint>& seen) {
  std::array<PairSums, channels> sums;
  for (std::size_t v = 0; v < base.size(); ++v) {
    for (std::size_t c = 0; c < channels; ++c) sums[c].add(base[v][c], seen[v][c]);
  }
  return sums;
}

/// With one multiple for all channels: not every channel needs to vary.
SeenLight of_white_diffuse(const std::array<PairSums, channels>& sums) {
  double square = 0;
  double product = 0;
  for (const PairSums& channel : sums) {
    square += channel.square();
    product += channel.product();
  }
  SeenLight light;
  for (std::size_t c = 0; c < channels; ++c) {
    light.factor[c] = square > 0 ? product / square : 0;
    light.added[c] = sums[c].mean_y() - light.factor[c] * sums[c].mean_x();
  }
  return light;
}

SeenLight of_coloured_diffuse(const std::array<PairSums, channels>& sums) {
  SeenLight light;
  for (std::size_t c = 0; c < channels; ++c) {
    light.factor[c] = sums[c].product() / sums[c].square();
    light.added[c] = sums[c].mean_y() - light.factor[c] * sums[c].mean_x();
  }
  return light;
}

double mean(const Tint& tint) {
  return (tint[0] + tint[1] + tint[2]) / channels;
}

/// Fits each channel's multiple, over the angles, to the mean of all channels; null if all are equal, or if the
/// angles do not determine it.
std::optional<std::array<Line, channels>> diffuse_colours(const std::vector<SeenLight>& angles) {
  constexpr double same = 0.03;
  std::array<Line, channels> lines;
  bool white = true;
  for (std::size_t c = 0; c < channels; ++c) {
    PairSums sums;
    for (const SeenLight& at : angles) sums.add(mean(at.factor), at.factor[c]);
    if (!(sums.deviation() > same * std::abs(sums.mean_x()))) return std::nullopt;
    lines[c].factor = sums.product() / sums.square();
    lines[c].offset = sums.mean_y() - lines[c].factor * sums.mean_x();
    white = white && std::abs(lines[c].factor - 1) < same && std::abs(lines[c].offset) < same;
  }
  if (white) return std::nullopt;
  // The split into ambient and diffuse light is arbitrary: take the one whose least ambient channel is zero.
  double least = std::numeric_limits<double>::infinity();
  for (const Line& line : lines) {
    if (!(line.factor > 0)) return std::nullopt;
    least = std::min(least, line.offset / line.factor);
  }
  for (Line& line : lines) line.offset = std::max(0.0, line.offset - line.factor * least);
  return lines;
}

/// Returns what is added in each channel, relative to the mean of all; ones if it is white, or nothing.
Tint highlight_colour(const std::vector<SeenLight>& angles) {
  constexpr double nothing = 0.02;
  constexpr double same = 0.03;
  double square = 0;
  double brightest = 0;
  Tint product{};
  for (const SeenLight& at : angles) {
    const double of_all = mean(at.added);
    brightest = std::max(brightest, of_all);
    square += of_all * of_all;
    for (std::size_t c = 0; c < channels; ++c) product[c] += of_all * at.added[c];
  }
  constexpr Tint white{1, 1, 1};
  if (brightest < nothing) return white;
  Tint colour{};
  for (std::size_t c = 0; c < channels; ++c) colour[c] = std::max(0.0, product[c] / square);
  const bool is_white = std::ranges::all_of(colour, [](double part) { return std::abs(part - 1) < same; });
  return is_white ? white : colour;
}

}  // namespace

volume::Light with_colours(volume::Light light, const std::vector<Tint>& base,
                           const std::vector<std::vector<Tint>>& seen) {
  std::vector<std::array<PairSums, channels>> sums;
  sums.reserve(seen.size());
  for (const std::vector<Tint>& at : seen) sums.push_back(sums_by_channel(base, at));
  if (sums.empty()) return light;
  const auto tells = [](const PairSums& channel) {
    return channel.deviation() > least_spread * channel.mean_x() && channel.square() > 0;
  };
  if (std::ranges::none_of(sums.front(), tells)) return light;
  std::vector<SeenLight> angles;
  if (std::ranges::all_of(sums.front(), tells)) {
    for (const auto& at : sums) angles.push_back(of_coloured_diffuse(at));
    if (const auto lines = diffuse_colours(angles)) {
      for (std::size_t c = 0; c < channels; ++c) {
        light.diffuse[c] = float((*lines)[c].factor);
        light.ambient[c] = float((*lines)[c].offset);
      }
    } else {
      angles.clear();
    }
  }
  if (angles.empty()) {
    for (const auto& at : sums) angles.push_back(of_white_diffuse(at));
  }
  const Tint highlight = highlight_colour(angles);
  for (std::size_t c = 0; c < channels; ++c) light.specular[c] = float(highlight[c]);
  return light;
}

ResponseFit response_fit(const volume::Light& light, const std::vector<Tint>& base,
                         const std::vector<Tint>& lit) {
  struct Row {
    double diffuse;
    double specular;
    double seen;
  };
  std::vector<Row> rows;
  for (std::size_t v = 0; v < base.size(); ++v) {
    for (std::size_t c = 0; c < channels; ++c)
      rows.push_back({double(light.diffuse[c]) * base[v][c], double(light.specular[c]),
                      lit[v][c] - double(light.ambient[c]) * base[v][c]});
  }
  const auto sum = [&](double Row::*a, double Row::*b) {
    double all = 0;
    for (const Row& row : rows) all += row.*a * row.*b;
    return all;
  };
  const double dd = sum(&Row::diffuse, &Row::diffuse);
  const double ds = sum(&Row::diffuse, &Row::specular);
  const double ss = sum(&Row::specular, &Row::specular);
  const double dy = sum(&Row::diffuse, &Row::seen);
  const double sy = sum(&Row::specular, &Row::seen);
  // If all base colours are one grey, diffuse and specular light cannot be separated, and need not be.
  const double along = ds * ds / ss;
  const bool spread = dd - along > least_spread * least_spread * along;
  ResponseFit fit;
  const double diffuse = spread ? (dy - ds * sy / ss) / (dd - along) : ds > 0 ? sy / ds : 0;
  const double specular = spread ? (sy - diffuse * ds) / ss : 0;
  fit.response = {float(diffuse), float(specular)};
  for (const Row& row : rows) {
    const double here = std::abs(diffuse * row.diffuse + specular * row.specular - row.seen);
    if (!(here <= fit.worst)) fit.worst = std::isfinite(here) ? here : std::numeric_limits<double>::infinity();
  }
  return fit;
}

}  // namespace understudy::spu
