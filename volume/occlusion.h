// SPDX-License-Identifier: Apache-2.0
// Occlusion between ranks while an image is being drawn, tile by tile: tiles that a rank nearer to the eye has
// drawn completely opaque hide those behind them, so that other ranks need neither draw nor send them.
#pragma once

namespace understudy::volume {

struct Image;
struct Rect;
struct RenderRequest;

/// Tile edge in pixels, along both axes; tiles begin at multiples of it, in window coordinates.
constexpr int occlusion_tile = 32;

/// Queried and updated by all drawing threads.
class Occlusion {
 public:
  virtual ~Occlusion() = default;

  /// Whether none of these pixels will be visible. Pixels that are visible now may be hidden later.
  virtual bool hides(const Rect& pixels) = 0;
  /// Reports that these pixels are drawn and opaque. Window tiles that lie completely in them now hide others.
  virtual void cover(const Rect& pixels) = 0;
  /// Whether to draw the last tiles first: if two equally fast ranks, one behind the other, began at the same
  /// end, one would always learn of occlusion too late.
  virtual bool from_the_end() const = 0;

 protected:
  Occlusion() = default;
  Occlusion(const Occlusion&) = default;
  Occlusion(Occlusion&&) = default;
  Occlusion& operator=(const Occlusion&) = default;
  Occlusion& operator=(Occlusion&&) = default;
};

/// Whether images of such a request can hide each other, and hidden tiles may be skipped.
bool can_occlude(const RenderRequest& request);

/// Whether the transparency of every pixel of `rect`, which lies inside `image`, is below the request's
/// termination threshold.
bool is_opaque(const Image& image, const Rect& rect, const RenderRequest& request);

/// Reports every completely drawn, opaque tile of an image to `occlusion`.
void cover_opaque_tiles(const Image& image, const RenderRequest& request, Occlusion& occlusion);

/// The tiles that `rect` overlaps, in units of tiles.
Rect tiles_touched(const Rect& rect);

}  // namespace understudy::volume
