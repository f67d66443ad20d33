// SPDX-License-Identifier: Apache-2.0
#include "volume/error_bound/error_bound.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "volume/error_bound/medium_variation.h"
#include "volume/image.h"
#include "volume/raycast/generic_field.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/ray_setup.h"
#include "volume/raycast/transfer_table.h"

namespace understudy::volume {
namespace {

using Place = std::array<float, 3>;

/// Rounding errors of an image's float arithmetic: per ray, and per sample.
constexpr double rounding_of_ray = 1e-6;
constexpr double rounding_of_sample = 2.5e-7;

/// A ray through the cells of the store, in lattice coordinates.
struct Ray {
  Place start{}, step{};

  Place at(float k) const {
    Place p;
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = k * step[axis] + start[axis];
    return p;
  }
  std::array<double, 3> at(double k) const {
    std::array<double, 3> p;
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = k * double(step[axis]) + double(start[axis]);
    return p;
  }
};

/// Bounds of the field's variation over a part of a ray within one cell, per length of the part, in entries of
/// the images' function.
struct AlongPart {
  double slope = 0;  ///< G
  double twist = 0;  ///< V, the greatest second derivative
};

AlongPart along_part(const Ray& ray, double length, const Variation& near, double scale) {
  AlongPart along;
  std::array<double, 3> speed{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    speed[axis] = length * std::abs(double(ray.step[axis]));
    // Slopes are infinite near a NaN.
    if (speed[axis] > 0) along.slope += speed[axis] * double(near.slope[axis]) * scale;
  }
  const double mixed = speed[0] * speed[1] + speed[1] * speed[2] + speed[0] * speed[2];
  if (mixed > 0) along.twist = 2 * mixed * double(near.twist) * scale;
  return along;
}

/// Bounds the difference between the mean of a quantity over a part and its value in the middle, given the
/// quantity's range, greatest slope and curvature, and sum of kinks over values.
double off_middle(const AlongPart& along, double range, double slope, double curve, double kinks) {
  // A cubic takes each value at most three times, and turns in between.
  const double passes = along.slope + 2 * along.twist;
  const double first_order = slope * along.slope / 4;
  const double second_order =
      slope * along.twist / 24 + curve * along.slope * along.slope / 24 + kinks * passes / 8;
  return std::min({range, first_order, second_order});
}

/// What composites from front to back: plain colours, with 1 as fourth channel, behind a transparency.
struct Composite {
  std::array<double, 4> shown{};
  double transparency = 1;

  void put_behind(const std::array<double, 4>& plain, double its_transparency) {
    for (std::size_t k = 0; k < 4; ++k) shown[k] += transparency * (1 - its_transparency) * plain[k];
    transparency *= its_transparency;
  }
};

template <typename FieldType>
class BoundWalk {
 public:
  BoundWalk(const Scene& scene, const FieldVariation& field, const MediumVariation& medium, float termination)
      : reader_(scene),
        scene_(scene),
        table_(*scene.table),
        scale_(double(table_.scale())),
        field_(field),
        medium_(medium),
        termination_(termination),
        brightest_(std::max(1.0, medium.brightest())) {
    // Start, step and their sum are rounded, each to floats of the lattice's extent.
    constexpr double ulp = 1.0 / (1 << 24);
    for (std::size_t axis = 0; axis < 3; ++axis)
      position_rounding_[axis] = std::max(1e-5, 6 * ulp * double(scene.store->lattice().cells[axis]));
  }

  /// Bound of the error of samples `first` to `last`, and their least opacity. If the ray continues in cells of
  /// other ranks, anything may follow.
  std::array<double, 2> bound(const Ray& ray, int first, int last, float last_length) {
    parts_.clear();
    image_ = {};
    double rounding = first == 0 ? brightest_ * rounding_of_ray : 0;  // once for all ranks' samples of a ray
    for (int k = first; k <= last && image_.transparency >= double(termination_); ++k) {
      rounding += add_segment(ray, k, k == last ? double(last_length) : 1);
      // A segment extends at most one step before its sample and one step behind it.
      const float empty = reader_.steps_in_empty(ray.step);
      if (empty >= 3) k += int(std::min(empty, 1e6F)) - 2;
    }
    // What lies behind the point where the ray became opaque is not sampled.
    const bool ended = image_.transparency < double(termination_);
    const bool open = !ended && last_length == 1;
    Total found = total(ended, open);
    for (int round = 0; round < most_rounds && worth_refining(found); ++round) {
      refine(ray, found.off_of_parts);
      found = total(ended, open);
    }
    return {found.apart + found.off + rounding, found.least_opaque};
  }

 private:
  /// A part of a segment that lies in one cell, with its sample in the middle.
  struct Part {
    double transparency = 1;
    std::array<double, 4> plain{};  ///< its plain colour, and 1
    double transparency_off = 0;    ///< bound of the error of its transparency
    double colour_off = 0;          ///< bound of the remaining error of its colour
    double middle = 0, length = 0;  ///< in steps
    double off = 0;                 ///< bound of the error that it adds where it lies

    double most_transparent() const { return std::min(transparency + transparency_off, 1.0); }
  };

  struct Total {
    double apart = 0;         ///< difference between the image and the parts
    double off = 0;           ///< bound of the difference between the parts and the integral
    double off_of_parts = 0;  ///< without what is not sampled
    double least_opaque = 0;
  };

  /// What the parts show behind a part.
  struct Behind {
    std::array<double, 4> shown{};
    double open = 0;  ///< transparency in front of the unknown rest; 0: nothing is unknown

    /// Bound of the difference between what is shown behind and a plain colour, in any channel.
    double farthest_from(const std::array<double, 4>& plain, double brightest) const {
      double most = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double unknown = open * (k < 3 ? brightest : 1);
        most = std::max({most, std::abs(shown[k] - plain[k]), std::abs(shown[k] + unknown - plain[k])});
      }
      return most;
    }
    void put_before(const Part& part) {
      for (std::size_t k = 0; k < 4; ++k)
        shown[k] = (1 - part.transparency) * part.plain[k] + part.transparency * shown[k];
      open *= part.transparency;
    }
  };

  /// `open`: something unknown may follow.
  Total total(bool ended, bool open) {
    Total found;
    double unsampled = ended ? brightest_ : 0, transparency = 1, most_transparent = 1;
    Behind behind;
    behind.open = open ? 1 : 0;
    for (auto part = parts_.rbegin(); part != parts_.rend(); ++part) {
      part->off = part->transparency_off * behind.farthest_from(part->plain, brightest_) + part->colour_off;
      found.off_of_parts = part->off + part->most_transparent() * found.off_of_parts;
      most_transparent *= part->most_transparent();
      transparency *= part->transparency;
      behind.put_before(*part);
    }
    // An image may take some samples more than are needed to become opaque.
    found.off = found.off_of_parts + (most_transparent + image_.transparency) * unsampled;
    found.least_opaque = 1 - most_transparent;
    for (std::size_t k = 0; k < 4; ++k) {
      const double known = behind.shown[k] - image_.shown[k];
      const double unknown = open ? (transparency - image_.transparency) * (k < 3 ? brightest_ : 1) : 0;
      found.apart = std::max({found.apart, std::abs(known), std::abs(known + unknown)});
    }
    return found;
  }

  /// Whether finer parts could lower the bound by much.
  bool worth_refining(const Total& found) const {
    return found.off_of_parts > std::max(0.5 * found.apart, negligible) && parts_.size() < most_parts;
  }

  /// Divides the parts that make up most of `off`.
  void refine(const Ray& ray, double off) {
    const double much = 0.5 * off / double(parts_.size());
    finer_.clear();
    double in_front = 1;
    for (const Part& part : parts_) {
      if (in_front * part.off <= much) {
        finer_.push_back(part);
      } else {
        for (int i = 0; i < division; ++i)
          finer_.push_back(
              part_at(ray, part.middle + ((i + 0.5) / division - 0.5) * part.length, part.length / division));
      }
      in_front *= part.most_transparent();
    }
    std::swap(parts_, finer_);
  }

  /// Composites the sample of a segment of `length` steps, and adds its parts. Returns a bound of the rounding
  /// errors of the sample in the image.
  double add_segment(const Ray& ray, int k, double length) {
    // The sample of a ray that is shorter than a step lies in its middle; otherwise, the last segment ends half
    // a step to one step behind its sample.
    const double from = double(k) - (k == 0 ? std::min(0.5, length / 2) : 0.5), to = from + length;
    const Variation near = field_.between(ray.at(from), ray.at(to));
    const float value = sample(ray.at(float(k)));
    // A NaN shows nothing.
    const bool absent = std::isnan(value);
    const double place = absent ? 0 : place_of(value);
    const double slope = along_part(ray, to - from, near, scale_).slope;
    const MediumBounds& bounds = medium_.around(entry_of(place), slope + rounding_of(near));
    if (bounds.depth == 0) return 0;
    add_parts(ray, from, to);
    const double in_front = image_.transparency;
    const double clear = absent ? 1 : show_sample(place, length);
    return in_front * (brightest_ * rounding_of_sample + rounding_of_length(clear, length) +
                       rounding_in_image(place, length, rounding_of(near)));
  }

  /// Bounds the change of a sample's contribution if its place changes by `rounding`.
  double rounding_in_image(double place, double length, double rounding) const {
    const MediumBounds& bounds = medium_.around(entry_of(place), rounding);
    // Near a NaN, the sample may also be absent.
    const bool near_nan = !std::isfinite(rounding);
    const double depth =
        length * (near_nan ? bounds.depth : std::min(bounds.depth_range, bounds.depth_slope * rounding));
    const double colour = std::min(bounds.colour_range, bounds.colour_slope * rounding);
    return brightest_ * std::min(1.0, depth) + (1 - std::exp(-length * bounds.depth)) * colour;
  }

  /// Bounds the change of the transparency of a segment shorter than a step if that of the whole step, `clear`,
  /// is rounded: where that is nearly 0, a small power of it is not.
  double rounding_of_length(double clear, double length) const {
    if (length >= 1) return 0;
    constexpr double rounding = 2.5e-7;
    const double highest = std::pow(clear + rounding, length);
    const double lowest = std::pow(std::max(clear - rounding, 0.0), length);
    return brightest_ * (highest - lowest);
  }

  /// Composites what the image shows of a sample. Returns the transparency of a whole step.
  double show_sample(double place, double length) {
    const std::size_t entry = entry_of(place);
    const float* const row = table_.rows() + 8 * entry;
    const double share = place - double(entry);
    const double alpha = std::min(1.0, double(row[3]) + share * double(row[7]));
    if (alpha <= 0) return 1;
    std::array<double, 4> plain{0, 0, 0, 1};
    for (std::size_t c = 0; c < 3; ++c) plain[c] = (double(row[c]) + share * double(row[4 + c])) / alpha;
    image_.put_behind(plain, alpha < 1 ? std::exp(length * std::log1p(-alpha)) : 0);
    return 1 - alpha;
  }

  /// Divides a stretch of a ray at the faces of cells, and into parts of at most a quarter of a step.
  void add_parts(const Ray& ray, double from, double to) {
    cuts_.assign({from, to});
    const auto low = ray.at(from), high = ray.at(to);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [first, last] = std::minmax(low[axis], high[axis]);
      for (double face = std::ceil(first); face <= std::floor(last) && last > first; ++face) {
        const double cut = (face - double(ray.start[axis])) / double(ray.step[axis]);
        if (cut > from && cut < to) cuts_.push_back(cut);
      }
    }
    std::ranges::sort(cuts_);
    for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
      const double whole = cuts_[i + 1] - cuts_[i];
      if (!(whole > 0)) continue;  // a ray may cross faces across two axes at once
      const int count = std::max(1, int(std::ceil(whole / longest_part)));
      for (int j = 0; j < count; ++j)
        parts_.push_back(part_at(ray, cuts_[i] + (j + 0.5) * whole / count, whole / count));
    }
  }

  Part part_at(const Ray& ray, double middle, double length) {
    const std::array<double, 3> position = ray.at(middle);
    const Variation& near = field_.at(position);
    const AlongPart along = along_part(ray, length, near, scale_);
    const float value = sample({float(position[0]), float(position[1]), float(position[2])});
    const double rounding = rounding_of(near);
    Part part;
    part.middle = middle;
    part.length = length;
    if (std::isnan(value)) return absent_part(ray, part);
    const double place = place_of(value);
    const MediumBounds& bounds = medium_.around(entry_of(place), along.slope / 2 + rounding);
    if (bounds.depth == 0) return part;

    const MediumPoint medium = medium_.at(place);
    part.transparency = std::exp(-length * medium.depth);
    for (std::size_t k = 0; k < 3; ++k) part.plain[k] = medium.colour[k];
    part.plain[3] = 1;
    const double off = length * (off_middle(along, bounds.depth_range, bounds.depth_slope, bounds.depth_curve,
                                            bounds.depth_kinks) +
                                 std::min(bounds.depth_range, bounds.depth_slope * rounding));
    // Neither the part nor the integral is more opaque than the densest value; depths bound the difference,
    // too.
    const double most_opaque = 1 - std::exp(-length * bounds.depth);
    // Infinite or NaN where slopes are steep.
    const double by_depth = part.transparency * std::expm1(off);
    part.transparency_off = by_depth <= most_opaque ? by_depth : most_opaque;
    part.colour_off = colour_off(along, length, bounds, rounding);
    return part;
  }

  /// A part in a cell with a NaN shows nothing, but its ends are known up to rounding only.
  Part absent_part(const Ray& ray, Part part) const {
    double speed = 0;
    for (const float component : ray.step) speed += std::abs(double(component));
    const double uncertain = std::min(part.length, speed > 0 ? 1e-3 / speed : part.length);
    const double depth = medium_.around(0, std::numeric_limits<double>::infinity()).depth;
    part.plain = {0, 0, 0, 1};
    part.transparency_off = 1 - std::exp(-uncertain * depth);
    part.colour_off = brightest_ * part.transparency_off;
    return part;
  }

  /// Bounds the integral of X - X_m over opacity.
  static double colour_off(const AlongPart& along, double length, const MediumBounds& bounds, double rounding) {
    const double depth = length * bounds.depth;
    const double opacity = 1 - std::exp(-depth);
    const double by_range = bounds.colour_range * opacity;
    const double off =
        off_middle(along, bounds.colour_range, bounds.colour_slope, bounds.colour_curve, bounds.colour_kinks) +
        bounds.colour_slope * rounding;
    // Bound of the change of opacity along the part.
    const double changes = length * bounds.depth_slope * along.slope + depth * depth;
    const double by_slopes = depth * off + bounds.colour_slope * along.slope * changes / 12;
    return std::min(by_range, std::isfinite(by_slopes) ? by_slopes : by_range);
  }

  float sample(const Place& position) {
    reader_.move_to(position, {}, scene_.top);
    return reader_.sample();
  }
  /// In entries of the images' function.
  double place_of(float value) const {
    return std::clamp((double(value) - double(table_.low())) * scale_, 0.0, double(table_.last()));
  }
  std::size_t entry_of(double place) const { return std::min(std::size_t(place), table_.entries() - 2); }
  /// How far a sample may be from its place because of rounded positions and values.
  double rounding_of(const Variation& near) const {
    double of_position = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      of_position += double(near.slope[axis]) * position_rounding_[axis];
    return of_position * scale_ + 3e-7 * (std::abs(double(table_.low())) * scale_ + double(table_.last())) +
           1e-6;
  }

  static constexpr double longest_part = 0.25;
  /// Parts are divided while a bound is above this, for so many rounds and into so many parts at most.
  static constexpr double negligible = 1e-5;
  static constexpr int most_rounds = 8;
  static constexpr int division = 4;
  static constexpr std::size_t most_parts = 4096;

  FieldReader<FieldType> reader_;
  const Scene& scene_;
  const TransferTable& table_;
  const double scale_;
  const FieldVariation& field_;
  const MediumVariation& medium_;
  float termination_;
  const double brightest_;                     ///< of any channel, at least 1
  std::array<double, 3> position_rounding_{};  ///< of a sample, in cells
  Composite image_;                            ///< of the current ray, as the image shows it
  std::vector<Part> parts_;                    ///< of the current ray
  std::vector<Part> finer_;
  std::vector<double> cuts_;
};

/// The parts of a request that bounds depend on.
struct BoundScene {
  BoundScene(const BrickStore& store, const RenderRequest& request)
      : table(std::get<TransferFunction>(request.classification), store.description().type, 0),
        skip(occupancy_of(store, table)),
        setup(request, store) {
    scene.store = &store;
    scene.table = &table;
    scene.skip = &skip;
    scene.rounding = setup.rounding;
    scene.filter = request.filter;
    scene.top = setup.top;
    for (std::size_t axis = 0; axis < 3; ++axis)
      scene.has_border[axis] = store.description().wrap[axis] == Wrap::border;
  }
  BoundScene(const BoundScene&) = delete;
  BoundScene& operator=(const BoundScene&) = delete;

  static OccupancyMap occupancy_of(const BrickStore& store, const TransferTable& table) {
    std::vector<bool> visible(store.blocks());
    for (std::size_t block = 0; block < visible.size(); ++block)
      visible[block] = table.shows(store.ranges(block).front());
    return {store.block_counts(), std::move(visible)};
  }

  TransferTable table;
  OccupancyMap skip;
  RaySetup setup;
  Scene scene;
};

/// Calls `take(x, y, {bound, least opacity})` for each ray of `rays` that has samples.
template <typename FieldType, typename Take>
void bound_rays(const BoundScene& bound_scene, const FieldVariation& field, const MediumVariation& medium,
                const RenderRequest& request, const Rect& rays, Take take) {
  const int rows = (rays.height + packet_height - 1) / packet_height;
  tbb::parallel_for(0, rows, [&](int row) {
    RayPacket packet;
    BoundWalk<FieldType> walk(bound_scene.scene, field, medium, request.termination);
    const int y = row * packet_height, height = std::min(packet_height, rays.height - y);
    for (int x = 0; x < rays.width; x += tile_width) {
      const int width = std::min(tile_width, rays.width - x);
      set_up_packet(bound_scene.setup, request, rays.x + x, rays.y + y, width, height, packet);
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
          const auto r = std::size_t(j) * std::size_t(tile_width) + std::size_t(i);
          if (packet.first[r] > packet.last[r]) continue;
          Ray ray;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            ray.start[axis] = packet.start[axis][r];
            ray.step[axis] = packet.step[axis][r];
          }
          take(rays.x + x + i, rays.y + y + j,
               walk.bound(ray, packet.first[r], packet.last[r], packet.last_length[r]));
        }
    }
  });
}

template <typename Take>
void bound_rays_of_any_type(const BoundScene& bound_scene, const FieldVariation& field,
                            const MediumVariation& medium, const RenderRequest& request, const Rect& rays,
                            Take take) {
  switch (bound_scene.scene.store->description().type) {
    case TexelType::u8:
      return bound_rays<StoredTexels<std::uint8_t>>(bound_scene, field, medium, request, rays, take);
    case TexelType::u16:
      return bound_rays<StoredTexels<std::uint16_t>>(bound_scene, field, medium, request, rays, take);
    case TexelType::f32:
      return bound_rays<StoredTexels<float>>(bound_scene, field, medium, request, rays, take);
    case TexelType::rgba8:  // refused by validate()
      return;
  }
}

void check(const BrickStore& store, const RenderRequest& request) {
  if (!request.bound_of)
    throw std::invalid_argument("a request for colours, where bounds of their error are drawn");
  validate(store.description(), request);
}

MediumVariation variation_of(const MediumFunction& medium, const RenderRequest& request) {
  return {medium.function, medium.step, std::get<TransferFunction>(request.classification)};
}

/// Converts to float, rounding up.
float upper(double bound) {
  if (std::isnan(bound)) return std::numeric_limits<float>::infinity();
  return std::nextafter(float(bound), std::numeric_limits<float>::max());
}

}  // namespace

ErrorBoundRenderer::ErrorBoundRenderer(const BrickStore& store) : store_(&store) {}
ErrorBoundRenderer::~ErrorBoundRenderer() = default;
ErrorBoundRenderer::ErrorBoundRenderer(ErrorBoundRenderer&&) noexcept = default;
ErrorBoundRenderer& ErrorBoundRenderer::operator=(ErrorBoundRenderer&&) noexcept = default;

void ErrorBoundRenderer::blocks_changed(std::span<const std::size_t> /*blocks*/) {
  variation_.reset();
}

void ErrorBoundRenderer::draw(const RenderRequest& request, Image& out, FrameCounts& /*counts*/,
                              Occlusion* /*occlusion*/) {
  check(*store_, request);
  std::ranges::fill(out.rgba, 0.0F);
  if (store_->empty()) return;
  if (!variation_) variation_ = std::make_unique<FieldVariation>(*store_);
  if (!medium_ || medium_function_ != *request.bound_of || of_images_ != request.classification) {
    medium_ = std::make_unique<MediumVariation>(variation_of(*request.bound_of, request));
    medium_function_ = *request.bound_of;
    of_images_ = request.classification;
  }
  const BoundScene bound_scene(*store_, request);
  const Rect pixels = intersection(out.rect, intersection(request.window, request.viewport));
  bound_rays_of_any_type(bound_scene, *variation_, *medium_, request, pixels,
                         [&](int x, int y, const std::array<double, 2>& found) {
                           float* const pixel = out.at(x, y);
                           pixel[0] = pixel[1] = pixel[2] = upper(found[0]);
                           pixel[3] = float(found[1]);
                         });
}

std::vector<float> error_bounds(const BrickStore& store, const FieldVariation& variation,
                                const RenderRequest& request, int pixels_apart) {
  check(store, request);
  const Rect& window = request.window;
  if (pixels_apart < 1 || window != request.viewport || window.x != 0 || window.y != 0)
    throw std::invalid_argument("bounds of few pixels are of a whole viewport that begins at (0, 0)");
  const Rect rays{0, 0, window.width / pixels_apart, window.height / pixels_apart};
  std::vector<float> bounds(rays.pixels(), 0);
  if (store.empty()) return bounds;
  BoundScene bound_scene(store, request);
  if (pixels_apart > 1) bound_scene.setup.spread(pixels_apart);
  const MediumVariation medium = variation_of(*request.bound_of, request);
  bound_rays_of_any_type(bound_scene, variation, medium, request, rays,
                         [&](int x, int y, const std::array<double, 2>& found) {
                           // The difference between two images is never greater.
                           bounds[std::size_t(y) * std::size_t(rays.width) + std::size_t(x)] =
                               upper(std::min(found[0], std::max(1.0, medium.brightest())));
                         });
  return bounds;
}

}  // namespace understudy::volume
