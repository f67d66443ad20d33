// SPDX-License-Identifier: Apache-2.0
// What ranks nearer to the eye have drawn already, tile by tile, while an image is still being drawn: tiles in
// which all their pixels are opaque hide what lies behind them, so that others need neither draw it nor send
// it.
#pragma once

namespace understudy::volume {

struct Image;
struct Rect;
struct RenderRequest;

/// Pixels, along both axes; tiles begin at multiples of it, in window coordinates.
constexpr int occlusion_tile = 32;

/// Asked and told by all threads that draw.
class Occlusion {
 public:
  virtual ~Occlusion() = default;

  /// Whether none of these pixels will be seen. What is visible now may be hidden later.
  virtual bool hides(const Rect& pixels) = 0;
  /// These pixels are drawn, and opaque. Tiles of the window that lie in them as a whole now hide others.
  virtual void cover(const Rect& pixels) = 0;
  /// Whether to draw the last tiles first: of two ranks, one behind the other and equally fast, one would
  /// always be told too late if both began at the same end.
  virtual bool from_the_end() const = 0;

 protected:
  Occlusion() = default;
  Occlusion(const Occlusion&) = default;
  Occlusion(Occlusion&&) = default;
  Occlusion& operator=(const Occlusion&) = default;
  Occlusion& operator=(Occlusion&&) = default;
};

/// Whether images of such a request can hide each other, and may be left out for that.
bool can_occlude(const RenderRequest& request);

/// Whether every pixel of `rect`, which lies inside `image`, lets less through than the request's rays go on
/// for.
bool is_opaque(const Image& image, const Rect& rect, const RenderRequest& request);

/// Tells `occlusion` of every tile of an image that has been drawn as a whole.
void cover_opaque_tiles(const Image& image, const RenderRequest& request, Occlusion& occlusion);

/// The tiles that `rect` touches, in units of tiles.
Rect tiles_touched(const Rect& rect);

}  // namespace understudy::volume
