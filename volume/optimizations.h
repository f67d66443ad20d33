// SPDX-License-Identifier: Apache-2.0
// Work that is skipped because it cannot change the image. Each optimization can be disabled, to measure its
// gain and to check that the image stays the same. A fourth one, skipping samples behind opaque ones, is
// controlled by RenderRequest::termination.
#pragma once

namespace understudy::volume {

/// True: the work is skipped.
struct Optimizations {
  /// Samples in blocks where the classification shows nothing. The image is bitwise the same, except for where
  /// rays terminate that become opaque.
  bool empty_bricks = true;
  /// Under a maximum, samples in blocks with nothing larger than the ray's maximum so far: same to rounding.
  bool dominated_samples = true;
  /// Between ranks: pixels that a rank's blocks cannot cover or no sample has reached, and ranks without any
  /// other pixels. Changes the order of summation: the image is the same to within 4e-6.
  bool footprints = true;

  bool operator==(const Optimizations&) const = default;
};

}  // namespace understudy::volume
