// SPDX-License-Identifier: Apache-2.0
// What the rendering of an image leaves out because it cannot change the image. Each can be done nevertheless,
// to see what it would cost and that the image stays what it is; the fourth of its kind, samples behind what is
// opaque, is RenderRequest::termination.
#pragma once

namespace understudy::volume {

/// True: the work is skipped.
struct Optimizations {
  /// Samples in blocks of which the classification shows nothing. The image is the same bit for bit, but for
  /// where rays end that become opaque.
  bool empty_bricks = true;
  /// Under a maximum, samples in blocks that show nothing larger than what the ray has seen: to rounding.
  bool dominated_samples = true;
  /// Pixels that a rank's blocks cannot touch, or that no sample has reached, between ranks; and ranks without
  /// any. Other sums are made of the same images: to 4e-6.
  bool footprints = true;

  bool operator==(const Optimizations&) const = default;
};

}  // namespace understudy::volume
