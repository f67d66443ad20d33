// SPDX-License-Identifier: Apache-2.0
#include "tests/emulation/slices.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace emulation {
namespace {

using Source = std::array<Bounded, 4>;

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Gauss-Jordan with pivoting.
Matrix inverse(const Matrix& m) {
  double rows[4][8]{};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) rows[r][c] = m[4 * c + r];
    rows[r][4 + r] = 1;
  }
  for (int pivot = 0; pivot < 4; ++pivot) {
    int best = pivot;
    for (int r = pivot + 1; r < 4; ++r)
      if (std::abs(rows[r][pivot]) > std::abs(rows[best][pivot])) best = r;
    std::swap(rows[pivot], rows[best]);
    const double divisor = rows[pivot][pivot];
    for (double& x : rows[pivot]) x /= divisor;
    for (int r = 0; r < 4; ++r) {
      if (r == pivot) continue;
      const double factor = rows[r][pivot];
      for (int c = 0; c < 8; ++c) rows[r][c] -= factor * rows[pivot][c];
    }
  }
  Matrix result;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) result[4 * c + r] = rows[r][4 + c];
  return result;
}

/// Trilinear sample at t, clamped to the edge. `spread`: how far the sample's position may be off along each
/// axis, in texels.
Source sample(const Field& field, const Vec3& t, const Vec3& spread) {
  std::array<int, 3> low{}, high{};
  Vec3 weight{};
  for (int axis = 0; axis < 3; ++axis) {
    const double position = t[axis] * field.size[axis] - 0.5;
    const int floor = static_cast<int>(std::floor(position));
    weight[axis] = position - floor;
    low[axis] = std::clamp(floor, 0, field.size[axis] - 1);
    high[axis] = std::clamp(floor + 1, 0, field.size[axis] - 1);
  }
  const auto texel = [&](int x, int y, int z, int channel) {
    const auto place = (static_cast<std::size_t>(z) * field.size[1] + y) * field.size[0] + x;
    return field.texels[place * field.components + channel];
  };
  Source result{};
  for (int channel = 0; channel < field.components; ++channel) {
    std::array<double, 8> corner;
    for (int i = 0; i < 8; ++i)
      corner[i] = texel(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2], channel);
    double value = 0;
    Vec3 steepest{};  // along each axis, the slope is greatest on an edge of the cell
    for (int i = 0; i < 8; ++i) {
      double part = 1;
      for (int axis = 0; axis < 3; ++axis) part *= i >> axis & 1 ? weight[axis] : 1 - weight[axis];
      value += part * corner[i];
      for (int axis = 0; axis < 3; ++axis)
        steepest[axis] = std::max(steepest[axis], std::abs(corner[i] - corner[i ^ (1 << axis)]));
    }
    double error = 0;
    for (int axis = 0; axis < 3; ++axis) error += spread[axis] * steepest[axis];
    result[channel] = within(error, exactly(value));
  }
  return result;
}

/// As sample(), but includes the slopes of a neighbouring cell that the sample may lie in.
Source sample_near_faces(const Field& field, const Vec3& t, const Vec3& spread) {
  Source result = sample(field, t, spread);
  for (int axis = 0; axis < 3; ++axis) {
    const double position = t[axis] * field.size[axis] - 0.5;
    const double to_face = position - std::round(position);
    if (std::abs(to_face) > spread[axis]) continue;
    Vec3 beyond = t;
    beyond[axis] -= (to_face + std::copysign(1e-9, to_face)) / field.size[axis];
    const Source other = sample(field, beyond, spread);
    for (int channel = 0; channel < field.components; ++channel)
      result[channel] = either(result[channel], other[channel]);
  }
  return result;
}

Bounded look_up(const Table& table, const Bounded& value, int channel) {
  // A byte filter has 8-bit weights and returns one of the two bytes next to the exact value.
  const double weight = table.bytes ? 1.0 / 256 : 0;
  const double low = value.low - weight / table.scale, high = value.high + weight / table.scale;
  Bounded result = exactly(entry_at(table, value.meant, channel));
  for (const double end : {low, high}) result = either(result, exactly(entry_at(table, end, channel)));
  const double last = static_cast<double>(table.entries.size() - 1);
  const auto first_inside = static_cast<long>(std::max(0.0, std::ceil(table.scale * low + table.offset)));
  const auto last_inside = static_cast<long>(std::min(last, std::floor(table.scale * high + table.offset)));
  for (long i = first_inside; i <= last_inside; ++i)
    result = either(result, exactly(table.entries[static_cast<std::size_t>(i)][channel]));
  if (table.bytes) {
    constexpr double rounding = 1e-9;  // of the bytes themselves, as doubles
    result.low = std::floor(255 * result.low + rounding) / 255;
    result.high = std::ceil(255 * result.high - rounding) / 255;
  }
  return result;
}

/// The fragment of one sample, and the error of a measured transfer function (premultiplied if `weighted`).
struct Fragment {
  Source colour{};
  Colour table_error{};
};

Fragment fragment(const Volume& volume, const Source& value, const Precision& precision, bool weighted) {
  Fragment result;
  for (int c = 0; c < 4; ++c) {
    Bounded colour = volume.field.components == 4 ? value[c] : look_up(volume.table, value[0], c);
    colour = clamped(colour);
    result.colour[c] = {colour.low * volume.factor[c], colour.meant * volume.factor[c],
                        colour.high * volume.factor[c]};
  }
  if (volume.field.components == 4 || precision.table_cells == 0) return result;
  // The measured transfer function is linear between its entries: half the second difference over one cell to
  // either side bounds its error, wherever the cell boundaries lie.
  const double cell = 1 / precision.table_cells;
  const auto at = [&](double place, int c) {
    const double colour = entry_at(volume.table, place, c) * volume.factor[c];
    return weighted && c < 3 ? colour * entry_at(volume.table, place, 3) * volume.factor[3] : colour;
  };
  const double place = value[0].meant;
  for (int c = 0; c < 4; ++c)
    result.table_error[c] = std::abs(at(place - cell, c) + at(place + cell, c) - 2 * at(place, c)) / 2;
  // For alpha whose square was measured.
  result.table_error[3] *= std::max(1.0, 2 * result.colour[3].high);
  return result;
}

double factor_of(Factor factor, double source_alpha, double destination_alpha) {
  switch (factor) {
    case Factor::zero:
      return 0;
    case Factor::one:
      return 1;
    case Factor::source_alpha:
      return source_alpha;
    case Factor::one_minus_source_alpha:
      return 1 - source_alpha;
    case Factor::destination_alpha:
      return destination_alpha;
    case Factor::one_minus_destination_alpha:
      return 1 - destination_alpha;
  }
  return 0;
}

Bounded blended(const BlendFunction& function, const Bounded& source, const Bounded& destination,
                const Bounded& source_alpha, const Bounded& destination_alpha) {
  if (function.equation == Equation::max)
    return {std::max(source.low, destination.low), std::max(source.meant, destination.meant),
            std::max(source.high, destination.high)};
  if (function.equation == Equation::min)
    return {std::min(source.low, destination.low), std::min(source.meant, destination.meant),
            std::min(source.high, destination.high)};
  const auto at = [&](double s, double d, double sa, double da) {
    return s * factor_of(function.source, sa, da) + d * factor_of(function.destination, sa, da);
  };
  // Increasing in source and destination and affine in each alpha: the extremes lie at the intervals' ends.
  Bounded result{1e300, at(source.meant, destination.meant, source_alpha.meant, destination_alpha.meant),
                 -1e300};
  for (const double sa : {source_alpha.low, source_alpha.high})
    for (const double da : {destination_alpha.low, destination_alpha.high}) {
      result.low = std::min(result.low, at(source.low, destination.low, sa, da));
      result.high = std::max(result.high, at(source.high, destination.high, sa, da));
    }
  return result;
}

/// Blends `source` into `pixel`. A fragment that is certainly zero causes no rounding.
void blend(const Blending& blending, Fragment source, const Rounding& rounding, Source& pixel) {
  const bool adds = blending.colour.equation == Equation::add;
  const bool weighted = blending.colour.source == Factor::source_alpha;
  bool nothing = adds && source.colour[3].high == 0;
  for (const Bounded& channel : source.colour) nothing = nothing && (weighted || channel.high == 0);
  if (nothing) return;
  for (int c = 0; c < 4; ++c) {
    const double error = c == 3 ? rounding.alpha_source : rounding.source;
    source.colour[c] = within(error, source.colour[c]);
    if (rounding.clamps) source.colour[c] = clamped(source.colour[c]);
  }
  const Source before = pixel;
  for (int c = 0; c < 4; ++c) {
    const BlendFunction& function = c == 3 ? blending.alpha : blending.colour;
    const double of_format = c == 3 ? rounding.alpha_result : rounding.result;
    pixel[c] = blended(function, source.colour[c], before[c], source.colour[3], before[3]);
    const bool stored_anew = function.equation == Equation::add;
    pixel[c] = within(source.table_error[c] + (stored_anew ? of_format : 0) +
                          (stored_anew ? rounding.relative * std::abs(pixel[c].high) : 0),
                      pixel[c]);
    if (rounding.clamps) pixel[c] = clamped(pixel[c]);
  }
}

/// Blends the result of a whole volume: `pixel` holds it already, and becomes the interval that may be stored.
void store(const Rounding& rounding, const Blending& blending, Source& pixel) {
  for (int c = 0; c < 4; ++c) {
    const BlendFunction& function = c == 3 ? blending.alpha : blending.colour;
    double error = c == 3 ? rounding.alpha_source : rounding.source;
    if (function.equation == Equation::add) error += c == 3 ? rounding.alpha_result : rounding.result;
    // The rounded alpha weights the destination, which is at most 1.
    if (c < 3 && function.equation == Equation::add && function.destination == Factor::one_minus_source_alpha)
      error += rounding.alpha_source;
    if (pixel[c].high < no_sample) error += rounding.relative * std::abs(pixel[c].high);
    pixel[c] = within(error, pixel[c]);
    if (rounding.clamps) pixel[c] = clamped(pixel[c]);
  }
}

/// An opaque triangle at one pixel.
struct Surface {
  double depth = 0;
  double depth_error = 0;
  bool sure = false;   ///< it covers the pixel's centre for any rounding of its vertices
  bool meant = false;  ///< it does so in exact arithmetic
  std::array<double, 3> colour{};
};

/// The opaque triangles over each pixel, bottom row first.
std::vector<std::vector<Surface>> rasterised(const Frame& frame, const Precision& precision) {
  std::vector<std::vector<Surface>> surfaces(static_cast<std::size_t>(frame.width) * frame.height);
  for (const Triangle& triangle : frame.solid) {
    std::array<Vec3, 3> p;
    for (int i = 0; i < 3; ++i)
      p[i] = {(triangle.clip[i][0] + 1) / 2 * frame.width, (triangle.clip[i][1] + 1) / 2 * frame.height,
              (triangle.clip[i][2] + 1) / 2};
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    if (area == 0) continue;
    const double slope_x =
        ((p[1][2] - p[0][2]) * (p[2][1] - p[0][1]) - (p[2][2] - p[0][2]) * (p[1][1] - p[0][1])) / area;
    const double slope_y =
        ((p[2][2] - p[0][2]) * (p[1][0] - p[0][0]) - (p[1][2] - p[0][2]) * (p[2][0] - p[0][0])) / area;
    const auto range = [&](int axis, int size) {
      const auto [least, most] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
      return std::array{std::max(0, static_cast<int>(std::floor(least - 1))),
                        std::min(size - 1, static_cast<int>(std::ceil(most + 1)))};
    };
    const auto [x0, x1] = range(0, frame.width);
    const auto [y0, y1] = range(1, frame.height);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        double inside = 1e9;  // distance to the nearest edge, in pixels
        for (int i = 0; i < 3; ++i) {
          const Vec3 &a = p[i], &b = p[(i + 1) % 3];
          const double ex = b[0] - a[0], ey = b[1] - a[1];
          const double side = (ex * (y + 0.5 - a[1]) - ey * (x + 0.5 - a[0])) / std::hypot(ex, ey);
          inside = std::min(inside, area > 0 ? side : -side);
        }
        if (inside < -precision.solid) continue;
        surfaces[static_cast<std::size_t>(y) * frame.width + x].push_back(
            {p[0][2] + slope_x * (x + 0.5 - p[0][0]) + slope_y * (y + 0.5 - p[0][1]),
             precision.depth + precision.solid * (std::abs(slope_x) + std::abs(slope_y)),
             inside >= precision.solid, inside >= 0, triangle.colour});
      }
  }
  return surfaces;
}

/// The surfaces that may be the visible one, the exact one first; null: no surface.
std::vector<const Surface*> seen(const std::vector<Surface>& surfaces) {
  const Surface* meant = nullptr;
  double surely_hidden_from = 2;
  for (const Surface& surface : surfaces) {
    if (surface.meant && (meant == nullptr || surface.depth < meant->depth)) meant = &surface;
    if (surface.sure) surely_hidden_from = std::min(surely_hidden_from, surface.depth + surface.depth_error);
  }
  std::vector<const Surface*> result{meant};
  for (const Surface& surface : surfaces)
    if (&surface != meant && surface.depth - surface.depth_error <= surely_hidden_from)
      result.push_back(&surface);
  // An edge inside a mesh belongs to one of its two triangles, so no hole opens between them; along an outline
  // one may.
  if (meant != nullptr && surely_hidden_from > 1) result.push_back(nullptr);
  return result;
}

/// One volume's slices at one pixel.
class PixelRay {
 public:
  PixelRay(const Frame& frame, const Volume& volume, const Matrix& texture_from_clip, int x, int y)
      : volume_(volume), clip_from_texture_(volume.clip_from_texture) {
    for (int i = 0; i < 3; ++i) {
      const double ndc_x = 2 * (x + 0.5 + (i == 1)) / frame.width - 1;
      const double ndc_y = 2 * (y + 0.5 + (i == 2)) / frame.height - 1;
      const Vec3 near = project(texture_from_clip, {ndc_x, ndc_y, -1});
      const Vec3 far = project(texture_from_clip, {ndc_x, ndc_y, 1});
      near_[i] = near;
      along_[i] = {far[0] - near[0], far[1] - near[1], far[2] - near[2]};
    }
  }

  /// Calls `take(fragment, sure, meant)` for every slice that certainly or possibly covers this pixel before
  /// `surface`.
  template <typename Take>
  void meet(const Precision& precision, const Surface* surface, bool weighted, Take take) const {
    for (const double offset : volume_.offsets) {
      const Vec3 t = crossing(0, offset);
      Vec3 per_pixel{};
      if (precision.window > 0)
        for (const int neighbour : {1, 2}) {
          const Vec3 other = crossing(neighbour, offset);
          for (int axis = 0; axis < 3; ++axis) per_pixel[axis] += std::abs(other[axis] - t[axis]);
        }
      bool sure = true, meant = true, possible = true;
      Vec3 spread{};
      for (int axis = 0; axis < 3; ++axis) {
        const double margin = precision.coordinate + precision.window * per_pixel[axis];
        spread[axis] = margin * volume_.field.size[axis] + precision.texel;
        sure = sure && t[axis] >= margin && t[axis] <= 1 - margin;
        meant = meant && t[axis] >= 0 && t[axis] <= 1;
        possible = possible && t[axis] >= -margin && t[axis] <= 1 + margin;
      }
      if (!possible) continue;
      if (surface != nullptr) {
        const double before = surface->depth - (project(clip_from_texture_, t)[2] + 1) / 2;
        const double error = surface->depth_error + precision.depth;
        if (before <= -error) continue;
        sure = sure && before > error;
        meant = meant && before > 0;
      }
      Source value = sample_near_faces(volume_.field, t, spread);
      for (int channel = 0; channel < volume_.field.components; ++channel)
        value[channel] = within(precision.value, value[channel]);
      take(fragment(volume_, value, precision, weighted), sure, meant);
    }
  }

 private:
  Vec3 crossing(int ray, double offset) const {
    const double s = (offset - dot(volume_.normal, near_[ray])) / dot(volume_.normal, along_[ray]);
    return {near_[ray][0] + s * along_[ray][0], near_[ray][1] + s * along_[ray][1],
            near_[ray][2] + s * along_[ray][2]};
  }

  const Volume& volume_;
  const Matrix& clip_from_texture_;
  std::array<Vec3, 3> near_{}, along_{};  // of this pixel, and of its right and upper neighbours
};

void lay_on(const Blending& blending, const Fragment& source, bool sure, bool meant, const Rounding& rounding,
            Source& pixel) {
  const Source without = pixel;
  blend(blending, source, rounding, pixel);
  if (sure) return;
  for (int c = 0; c < 4; ++c) pixel[c] = meant ? either(pixel[c], without[c]) : either(without[c], pixel[c]);
}

Fragment solid_colour(const Frame& frame, const Surface* surface) {
  Fragment result;
  for (int c = 0; c < 3; ++c)
    result.colour[c] = exactly(surface != nullptr ? surface->colour[c] : frame.background[c]);
  result.colour[3] = exactly(surface != nullptr ? 1 : frame.background[3]);
  return result;
}

/// Calls `pixel_before(rays, surface)` for every surface that may be visible at each pixel, and unites the
/// returned intervals.
template <typename PixelBefore>
Image for_each_pixel(const Frame& frame, const std::vector<const Volume*>& volumes, const Precision& precision,
                     PixelBefore pixel_before) {
  Image image{frame.width, frame.height, {}};
  const auto surfaces = rasterised(frame, precision);
  std::vector<Matrix> texture_from_clip;
  texture_from_clip.reserve(volumes.size());
  for (const Volume* volume : volumes) texture_from_clip.push_back(inverse(volume->clip_from_texture));
  for (int y = frame.height - 1; y >= 0; --y)
    for (int x = 0; x < frame.width; ++x) {
      std::vector<PixelRay> rays;
      for (std::size_t i = 0; i < volumes.size(); ++i)
        rays.emplace_back(frame, *volumes[i], texture_from_clip[i], x, y);
      Source united{};
      bool first = true;
      for (const Surface* surface : seen(surfaces[static_cast<std::size_t>(y) * frame.width + x])) {
        const Source pixel = pixel_before(rays, surface);
        for (int c = 0; c < 4; ++c) united[c] = first ? pixel[c] : either(united[c], pixel[c]);
        first = false;
      }
      image.pixels.push_back(united);
    }
  return image;
}

}  // namespace

Vec3 project(const Matrix& m, const Vec3& p) {
  Colour h{};
  for (int r = 0; r < 4; ++r) h[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
  return {h[0] / h[3], h[1] / h[3], h[2] / h[3]};
}

double entry_at(const Table& table, double value, std::size_t channel) {
  const double last = static_cast<double>(table.entries.size() - 1);
  const double place = std::clamp(table.scale * value + table.offset, 0.0, last);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, table.entries.size() - 1);
  return std::lerp(table.entries[below][channel], table.entries[above][channel],
                   place - static_cast<double>(below));
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

namespace {

bool is_front_to_back(const Blending& blending) {
  return blending.colour.source == Factor::one_minus_destination_alpha ||
         blending.colour.source == Factor::destination_alpha;
}

bool rounds(const Rounding& rounding) {
  return rounding.source > 0 || rounding.result > 0 || rounding.relative > 0;
}

/// Composites one volume's slices onto an empty pixel.
Source alone(const PixelRay& ray, const Surface* surface, const Blending& own, const Precision& precision) {
  const bool weighted = own.colour.source == Factor::source_alpha;
  Blending blending{own.colour, own.colour};
  if (weighted) blending.alpha.source = Factor::one;
  const Rounding none{.clamps = false};
  Source pixel{};
  if (own.colour.equation == Equation::min) pixel.fill(exactly(no_sample));
  struct Met {
    Fragment fragment;
    bool sure, meant;
  };
  std::vector<Met> met;
  ray.meet(precision, surface, weighted, [&](const Fragment& fragment, bool sure, bool meant) {
    met.push_back({fragment, sure, meant});
  });
  if (is_front_to_back(own)) {
    // The same back to front, where every operation depends on one sample's alpha alone, so the bounds stay
    // narrow.
    blending.colour = blending.alpha = {Equation::add, Factor::one, Factor::one_minus_source_alpha};
    std::reverse(met.begin(), met.end());
  }
  for (const Met& m : met) lay_on(blending, m.fragment, m.sure, m.meant, none, pixel);
  return pixel;
}

}  // namespace

Image draw(const Frame& frame, const Precision& precision, const Rounding& each_slice,
           const Rounding& each_volume) {
  std::vector<const Volume*> volumes;
  for (const Volume& volume : frame.volumes) volumes.push_back(&volume);
  const bool weighted = frame.blending.colour.source == Factor::source_alpha;
  const bool in_one = is_front_to_back(frame.blending) && !rounds(each_slice);
  const auto pixel_before = [&](const std::vector<PixelRay>& rays, const Surface* surface) {
    Source pixel{};
    const Fragment behind = solid_colour(frame, surface);
    if (!frame.background_last) {
      pixel = behind.colour;
      // The background was rounded when it was stored.
      const double absolute = std::max(each_slice.source, each_volume.source);
      const double relative = std::max(each_slice.relative, each_volume.relative);
      for (Bounded& channel : pixel) channel = clamped(within(absolute + relative * channel.meant, channel));
    }
    for (const PixelRay& ray : rays) {
      if (in_one) {
        // No single slice is brighter than 1, but their sum may be.
        blend(frame.blending, {alone(ray, surface, frame.blending, precision), {}}, {.clamps = false}, pixel);
      } else {
        ray.meet(precision, surface, weighted, [&](const Fragment& fragment, bool sure, bool meant) {
          lay_on(frame.blending, fragment, sure, meant, each_slice, pixel);
        });
      }
      store(each_volume, frame.blending, pixel);
    }
    if (frame.background_last) {
      blend(frame.blending, behind, each_slice, pixel);
      store(each_volume, frame.blending, pixel);
    }
    return pixel;
  };
  return for_each_pixel(frame, volumes, precision, pixel_before);
}

Image draw_alone(const Frame& frame, const Volume& volume, const Precision& precision) {
  return for_each_pixel(frame, {&volume}, precision,
                        [&](const std::vector<PixelRay>& rays, const Surface* surface) {
                          return alone(rays[0], surface, frame.blending, precision);
                        });
}

std::vector<double> meant(const Image& image, int channels) {
  std::vector<double> values;
  for (const auto& pixel : image.pixels)
    for (int c = 0; c < channels; ++c) values.push_back(pixel[c].meant);
  return values;
}

Verdict judge(const Image& image, const std::vector<double>& drawn, int channels, double slack) {
  if (drawn.size() != image.pixels.size() * channels)
    throw std::invalid_argument("the image to be judged has another size than the one that was meant");
  Verdict verdict;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const Bounded& bound = image.pixels[i / channels][i % channels];
    const double beyond = std::max(bound.low - drawn[i], drawn[i] - bound.high);
    verdict.beyond = std::max(verdict.beyond, beyond);
    if (beyond > slack) ++verdict.outside;
    // For a minimum along an edge, one image may have a sample where the other has none.
    if (bound.high == no_sample || drawn[i] > 1e30) continue;
    const double error = drawn[i] - bound.meant;
    verdict.rms += error * error;
    verdict.max = std::max(verdict.max, std::abs(error));
    const double room = std::max(bound.high - bound.meant, bound.meant - bound.low);
    verdict.width += room * room;
    ++counted;
  }
  verdict.rms = std::sqrt(verdict.rms / static_cast<double>(std::max<std::size_t>(counted, 1)));
  verdict.width = std::sqrt(verdict.width / static_cast<double>(std::max<std::size_t>(counted, 1)));
  return verdict;
}

}  // namespace emulation
