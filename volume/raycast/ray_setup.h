// SPDX-License-Identifier: Apache-2.0
// Computes rays from pixels. In clip space, pixel (X, Y) is the line x = X w, y = Y w. With the rows A0 .. A3
// of the matrix, it meets plane s at the point t of texture space that solves
//
//     (A0 - X A3) . (t, 1) = 0,   (A1 - Y A3) . (t, 1) = 0,   normal . t = s.
//
// Cramer's rule gives t = (h + s c) / det with h, c and det = normal . c linear in X and Y (the products X Y
// cancel, since A3 x A3 = 0). So are all other quantities of a ray, and every bound on the sample index i
// (region, near, far and clip planes) has the form (value + i slope) / det >= 0 with value and slope linear in
// X and Y.
//
// For samples at constant steps along the ray, the index is a continuous parameter: a plane through the centre
// of the region defines it, the region's bounds give entry and exit, and the steps between them are counted.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/sampling.h"
#include "volume/texel_box.h"

namespace understudy::volume {

struct Rect;
struct RenderRequest;

/// c + x X + y Y over normalised device coordinates.
struct LinearInPixel {
  double c = 0;
  double x = 0;
  double y = 0;
};

/// Keeps the sample indices i with (value + i slope) / det >= 0.
struct IndexBound {
  LinearInPixel value;
  LinearInPixel slope;
};

struct RaySetup {
  RaySetup(const RenderRequest& request, const BrickStore& store)
      : RaySetup(request, store, store.owned_cells()) {}
  /// The same for `owned`, a part of the store's owned cells, in their place.
  RaySetup(const RenderRequest& request, const BrickStore& store, const TexelBox& owned);

  /// From now on, ray (x, y) is the ray of the pixel in the centre of the square of `pixels` x `pixels` pixels
  /// whose lowest pixel is pixels * (x, y): few rays represent all. Call it once.
  void spread(int pixels);
  /// The pixel of ray `at` along an axis.
  int pixel_of(int at) const { return at * pixels_apart + pixels_apart / 2; }

  LinearInPixel det;
  double smallest_det = 0;             ///< rays with |det| at most this are parallel to the planes
  std::array<IndexBound, 3> position;  ///< sample position in lattice coordinates, times det
  std::vector<IndexBound> bounds;      ///< the first six are the region's
  std::optional<RaySteps> steps;
  std::array<LinearInPixel, 3>
      speed;                  ///< with steps: number of steps per unit of the index, as a vector, times det
  IndexBound clip_z, clip_w;  ///< clip coordinates of sample i, times det
  double pixel_to_x = 0, first_x = 0;  ///< X of the centre of pixel x: first_x + x pixel_to_x
  double pixel_to_y = 0, first_y = 0;
  int pixels_apart = 1;  ///< distance of neighbouring rays, along both axes
  int last_plane = 0;
  bool segments = false;  ///< intervals between samples are integrated
  bool ends = false;      ///< the packet's begin and end are set
  bool cut = false;       ///< segments end at the boundary of the owned cells

  /// Bounds of the owned cells in lattice coordinates: owned_low <= position < owned_high, on the sides that
  /// low_is_bound and high_is_bound mark.
  std::array<float, 3> owned_low{}, owned_high{};
  std::array<bool, 3> low_is_bound{}, high_is_bound{};
  std::array<float, 3> resting_place{};  ///< inside the lowest owned cell
  /// Positions are clamped to [0, top].
  std::array<float, 3> top{};
  /// Bounds of the rounding errors of positions, in cells.
  std::array<float, 3> rounding{};

 private:
  void set_viewport(const Rect& viewport);
  /// Sets the members from owned_low to rounding.
  void set_cells(const RenderRequest& request, const BrickStore& store, const TexelBox& owned);
};

constexpr int tile_width = 32;
constexpr int packet_height = 4;
constexpr int packet_rays = tile_width * packet_height;

/// A packet of neighbouring rays, row by row. Sample k of a ray lies at start + k * step (rounded to float
/// after each of the two operations), in lattice coordinates; first <= k <= last are its samples in the owned
/// cells.
///
/// Segment k reaches from u(k) to u(k + 1), u(i) = clamp(i, begin, end), in steps; first <= k <= last are those
/// whose front lies in the owned cells. Segment -1, which is shorter than a step, has no sample at its front.
struct RayPacket {
  alignas(64) std::array<std::array<float, packet_rays>, 3> start;
  alignas(64) std::array<std::array<float, packet_rays>, 3> step;
  alignas(64) std::array<int, packet_rays> first;
  alignas(64) std::array<int, packet_rays> last;
  alignas(64) std::array<float, packet_rays> begin;  ///< > -1
  alignas(64) std::array<float, packet_rays> end;
  /// Length of the interval that the last sample represents, in steps. Set if samples cover the whole ray.
  alignas(64) std::array<float, packet_rays> last_length;
};

/// Sets up the rays (x .. x + width, y .. y + height), one per pixel unless spread() was called; the rest of
/// the packet gets rays without samples. These have a constant position in the lowest owned cell, where it is
/// safe to sample. Returns whether any ray has a sample.
bool set_up_packet(const RaySetup& setup, const RenderRequest& request, int x, int y, int width, int height,
                   RayPacket& packet);

}  // namespace understudy::volume
