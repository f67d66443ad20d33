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
};

/// Bounds of the field's variation along a segment, in entries of the images' function.
struct AlongRay {
  double slope = 0;     ///< G, the greatest slope
  double bend = 0;      ///< V, the variation of the slope
  double weighted = 0;  ///< W: V weighted by the Peano kernel of the midpoint rule
  int cells = 1;        ///< number of cells that the segment may cross
};

/// The Peano kernel of the midpoint rule over [0, 1]: the contribution of a jump of the derivative at `place`
/// to the error. Positions are known up to rounding.
double peano_kernel(double place) {
  constexpr double rounding = 2e-3;
  const double to_end = 0.5 - std::max(std::abs(place - 0.5) - rounding, 0.0);
  return to_end > 0 ? to_end * to_end / 2 : 0;
}

/// Bounds along `length` steps of a ray, from `from` to `to`.
AlongRay along_ray(const Ray& ray, const Place& from, const Place& to, double length, const Variation& near,
                   double scale) {
  AlongRay along;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double speed = std::abs(double(ray.step[axis]));
    along.slope += speed * double(near.slope[axis]);
    const double jump = speed * double(near.bend[axis]);
    // Cell faces between the two positions, or so close that rounding may lead past them.
    constexpr double rounding = 1e-3;
    const auto [low, high] = std::minmax({double(from[axis]), double(to[axis])});
    const auto first = int(std::ceil(low - rounding)), last = int(std::floor(high + rounding));
    for (int face = first; face <= last; ++face) {
      const double share = high > low ? (face - low) / (high - low) : 0.5;
      along.bend += jump;
      along.weighted += jump * peano_kernel(from[axis] < to[axis] ? share : 1 - share);
      ++along.cells;
    }
  }
  const double x = std::abs(double(ray.step[0])), y = std::abs(double(ray.step[1])),
               z = std::abs(double(ray.step[2]));
  const double twist = 2 * (x * y + y * z + x * z) * double(near.twist);
  along.bend += length * twist;
  along.weighted += twist / 24;
  along.slope *= scale;
  along.bend *= scale;
  along.weighted *= scale;
  return along;
}

/// Bounds the difference between the mean of a quantity over a segment of `length` steps and its value half a
/// step after the segment's start, given the quantity's range, greatest slope and curvature, and sum of kinks
/// over values.
double off_middle(const AlongRay& along, double length, double range, double slope, double curve,
                  double kinks) {
  if (length == 1) {
    // A cubic takes each value at most three times.
    const double passes = along.slope + (3 * along.cells - 1) * along.bend;
    const double first_order = slope * along.slope / 4;
    const double second_order =
        slope * along.weighted + curve * along.slope * along.slope / 24 + kinks * passes / 8;
    return std::min({range, first_order, second_order});
  }
  const double behind = length - 0.5;
  const double first_order = slope * along.slope * (0.125 + behind * behind / 2) / length;
  return std::min(range, first_order);
}

template <typename FieldType>
class BoundWalk {
 public:
  BoundWalk(const Scene& scene, const FieldVariation& field, const MediumVariation& medium, float termination)
      : reader_(scene), scene_(scene), field_(field), medium_(medium), termination_(termination) {}

  /// Bound of the error of samples `first` to `last`, and their least opacity. If the ray continues in cells of
  /// other ranks, anything may follow.
  std::array<double, 2> bound(const Ray& ray, int first, int last, float last_length) {
    segments_.clear();
    double transparency = 1;
    for (int k = first; k <= last && transparency >= double(termination_); ++k) {
      segments_.push_back(segment_at(ray, k, k == last ? double(last_length) : 1));
      transparency *= segments_.back().transparency;
      // A segment extends at most one step before its sample and one step behind it.
      const float empty = reader_.steps_in_empty(ray.step);
      if (empty >= 3) k += int(std::min(empty, 1e6F)) - 2;
    }
    // What lies behind the point where the ray became opaque is not sampled.
    const bool ended = transparency < double(termination_);
    const double brightest = std::max(1.0, medium_.brightest());
    double bound = ended ? brightest : 0;
    double least_opaque = 0;
    Behind behind;
    behind.open = !ended && last_length == 1 ? 1 : 0;
    for (auto segment = segments_.rbegin(); segment != segments_.rend(); ++segment) {
      const double most_transparent = std::min(segment->transparency + segment->transparency_off, 1.0);
      bound = segment->transparency_off * behind.farthest_from(segment->plain, brightest) +
              segment->colour_off + most_transparent * bound;
      least_opaque = 1 - most_transparent * (1 - least_opaque);
      behind.put_before(*segment);
    }
    // Added once for all parts of a ray.
    return {bound + (first == 0 ? rounding_of_ray : 0), least_opaque};
  }

 private:
  struct Segment {
    double transparency = 1;        ///< in the image
    std::array<double, 4> plain{};  ///< its plain colour, and 1
    double transparency_off = 0;    ///< bound of the error of its transparency
    double colour_off = 0;          ///< bound of the remaining error of its colour
  };

  /// What the image shows behind a segment.
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
    void put_before(const Segment& segment) {
      for (std::size_t k = 0; k < 4; ++k)
        shown[k] = (1 - segment.transparency) * segment.plain[k] + segment.transparency * shown[k];
      open *= segment.transparency;
    }
  };

  Segment segment_at(const Ray& ray, int k, double length) {
    const Place middle = ray.at(float(k));
    // A ray's last segment may be shorter or longer; the only one of a short ray has its sample in the middle.
    const double before = std::min(0.5, length), behind = std::max(length - 0.5, length / 2);
    const Place from = ray.at(float(double(k) - before)), to = ray.at(float(double(k) + behind));
    const Variation near = field_.between(from, to);
    const TransferTable& table = *scene_.table;
    const AlongRay along = along_ray(ray, from, to, before + behind, near, double(table.scale()));

    reader_.move_to(middle, {}, scene_.top);
    const float value = reader_.sample();
    const float place =
        std::isnan(value) ? 0 : std::clamp((value - table.low()) * table.scale(), 0.0F, table.last());
    const auto entry = std::min(std::size_t(place), table.entries() - 2);
    const double steepest = double(std::max({near.slope[0], near.slope[1], near.slope[2]}));
    const double rounding = 1e-5 * (steepest * double(table.scale()) + 1);
    const MediumBounds& bounds = medium_.around(entry, along.slope * std::max(before, behind) + rounding);
    Segment segment;
    if (bounds.depth == 0 && bounds.glow == 0) return segment;

    const float* const row = table.rows() + 8 * entry;
    const double alpha = std::min(1.0, double(row[3]) + (double(place) - double(entry)) * double(row[7]));
    const double transparency = alpha < 1 ? std::exp(length * std::log1p(-alpha)) : 0;
    const double off = length * (off_middle(along, length, bounds.depth_range, bounds.depth_slope,
                                            bounds.depth_curve, bounds.depth_kinks) +
                                 bounds.depth_error + bounds.depth_slope * rounding);
    segment.transparency = transparency;
    for (std::size_t k = 0; k < 3 && alpha > 0; ++k)
      segment.plain[k] = (double(row[k]) + (double(place) - double(entry)) * double(row[4 + k])) / alpha;
    segment.plain[3] = 1;
    // Neither image nor integral is more opaque than the densest value; depths bound the difference, too.
    const double most_opaque = 1 - std::exp(-length * (bounds.depth + bounds.depth_error));
    // Infinite or NaN where slopes are steep.
    const double by_depth = transparency * std::expm1(off);
    segment.transparency_off = by_depth <= most_opaque ? by_depth : most_opaque;
    segment.colour_off =
        colour_off(along, length, bounds) + length * (bounds.colour_error + bounds.glow) + rounding_of_sample;
    return segment;
  }

  /// Bounds the integral of X - X_m over opacity.
  static double colour_off(const AlongRay& along, double length, const MediumBounds& bounds) {
    const double opacity = 1 - std::exp(-length * bounds.depth);
    const double by_range = bounds.colour_range * opacity;
    if (length != 1) return by_range;
    const double off = off_middle(along, 1, bounds.colour_range, bounds.colour_slope, bounds.colour_curve,
                                  bounds.colour_kinks);
    // Bound of the change of opacity per step along the segment.
    const double changes = bounds.depth_slope * along.slope + bounds.depth * bounds.depth;
    const double by_slopes = bounds.depth * off + bounds.colour_slope * along.slope * changes / 12;
    return std::min(by_range, std::isfinite(by_slopes) ? by_slopes : by_range);
  }

  FieldReader<FieldType> reader_;
  const Scene& scene_;
  const FieldVariation& field_;
  const MediumVariation& medium_;
  float termination_;
  std::vector<Segment> segments_;  ///< of the current ray
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
