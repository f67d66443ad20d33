// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/kept_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "spu/volume/proxy/field_probe.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

/// Returns places in [-1,1]^2 around which the box may be seen, that of its middle first.
std::vector<std::array<double, 2>> places_to_enlarge(const RaysThroughBox& rays) {
  constexpr int to_each_side = 4;
  std::vector<std::array<double, 2>> places{rays.middle()};
  for (int y = -to_each_side; y <= to_each_side; ++y) {
    for (int x = -to_each_side; x <= to_each_side; ++x)
      places.push_back({0.9 * x / to_each_side, 0.9 * y / to_each_side});
  }
  return places;
}

/// Whether every ray of the square of this half edge around a place has a long enough path through the box.
bool is_covered(const RaysThroughBox& rays, const std::array<double, 2>& place, double half) {
  if (std::abs(place[0]) + half > 1 || std::abs(place[1]) + half > 1) return false;
  const auto middle = rays.way(place[0], place[1]);
  if (!middle) return false;
  // The box covers a convex area, so the corners suffice. Near its rim rays are so short that programs may
  // discard them.
  constexpr double long_enough = 0.25;
  for (const double x : {place[0] - half, place[0] + half}) {
    for (const double y : {place[1] - half, place[1] + half}) {
      const auto way = rays.way(x, y);
      if (!way || volume::length(*way) < long_enough * volume::length(*middle)) return false;
    }
  }
  return true;
}

/// Returns a viewport in which the box covers all pixels of the application's; null if it would be too large.
std::optional<volume::Rect> enlarged_viewport(const FieldProbe& probe, const RaysThroughBox& rays) {
  constexpr double finer = 0.8;
  const auto places = places_to_enlarge(rays);
  for (double half = 1;; half *= finer) {
    const double width = probe.width() / half, height = probe.height() / half;
    if (width > probe.largest_viewport()[0] || height > probe.largest_viewport()[1]) return std::nullopt;
    for (const auto& place : places) {
      if (!is_covered(rays, place, half)) continue;
      return volume::Rect{int(std::lround(probe.left() + 0.5 * probe.width() - (place[0] + 1) / 2 * width)),
                          int(std::lround(probe.bottom() + 0.5 * probe.height() - (place[1] + 1) / 2 * height)),
                          int(std::lround(width)), int(std::lround(height))};
    }
  }
}

/// Pixels [first, last) of a row or column.
struct Interval {
  int first = 0;
  int last = 0;
  bool operator==(const Interval&) const = default;
  bool empty() const { return first >= last; }
  int at(double part) const { return first + int(part * (last - first - 1)); }
};

class KeptPixels {
 public:
  KeptPixels(FieldProbe& probe, const volume::Rect& enlarged) : probe_(probe), enlarged_(enlarged) {}

  /// Finds the field that shows fragments, and returns a row in which some are kept; null if there is none.
  std::optional<int> find_row(const std::array<float, 2>& range) {
    for (const float value : {range[1], (range[0] + range[1]) / 2, range[0]}) {
      value_ = value;
      // Halves, quarters, and so on: a view may be a small part of its window.
      for (int parts = 2; parts <= 32; parts *= 2) {
        for (int part = 1; part < parts; part += 2) {
          const int y = probe_.height() * part / parts;
          if (const auto interval = row(y); !interval || !interval->empty()) return y;
        }
      }
    }
    return std::nullopt;
  }

  /// Null if what is kept has holes.
  std::optional<Interval> row(int y) { return interval_in({0, y, probe_.width(), 1}); }
  std::optional<Interval> column(int x) { return interval_in({x, 0, 1, probe_.height()}); }

  /// Whether the rectangle of the intervals is what is kept, as far as its sides and a few lines through it
  /// show.
  bool is_rectangle(const Interval& columns, const Interval& rows) {
    for (const double part : {0.0, 0.25, 0.75, 1.0}) {
      if (row(rows.at(part)) != columns || column(columns.at(part)) != rows) return false;
    }
    const auto nothing = [](const std::optional<Interval>& line) { return line && line->empty(); };
    return (rows.first == 0 || nothing(row(rows.first - 1))) &&
           (rows.last == probe_.height() || nothing(row(rows.last))) &&
           (columns.first == 0 || nothing(column(columns.first - 1))) &&
           (columns.last == probe_.width() || nothing(column(columns.last)));
  }

 private:
  std::optional<Interval> interval_in(const volume::Rect& line) {
    const std::vector<bool> kept = probe_.kept_in(line, enlarged_, value_);
    const auto first = std::ranges::find(kept, true);
    const auto last = std::find(first, kept.end(), false);
    if (std::find(last, kept.end(), true) != kept.end()) return std::nullopt;
    if (first == kept.end()) return Interval{};
    return Interval{int(first - kept.begin()), int(last - kept.begin())};
  }

  FieldProbe& probe_;
  volume::Rect enlarged_;
  float value_ = 0;
};

}  // namespace

std::variant<volume::Rect, Refusal> kept_rect(const MarchContext& measured, const ProxyBox& box) {
  MarchContext all_pixels = measured;
  all_pixels.kept.reset();
  FieldProbe probe(all_pixels);
  if (!probe.complete()) return Refusal{"the driver offers no float framebuffer to compare images in"};
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto enlarged = enlarged_viewport(probe, rays);
  if (!enlarged)
    return Refusal{
        "fragments are discarded by their place, and the volume is too small in the window to tell where",
        {},
        "move the eye closer to the volume"};
  KeptPixels pixels(probe, *enlarged);
  const auto found = pixels.find_row(measured.range);
  if (!found) return Refusal{"fragments are discarded by their place, and none is kept"};
  const auto columns = pixels.row(*found);
  const auto rows = columns ? pixels.column(columns->at(0.5)) : std::nullopt;
  if (!rows || !pixels.is_rectangle(*columns, *rows))
    return Refusal{"fragments are discarded by their place, and those that are kept do not fill a rectangle"};
  return volume::Rect{probe.left() + columns->first, probe.bottom() + rows->first,
                      columns->last - columns->first, rows->last - rows->first};
}

}  // namespace understudy::spu
