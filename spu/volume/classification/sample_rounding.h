// SPDX-License-Identifier: Apache-2.0
// Samples as computed by drivers that filter 8-bit texels in 8 bits.
//
// llvmpipe rounds the position of a sample to 1/256 of a texel, and every interpolation along an axis to a
// multiple of 1/255 (volume/texture_filter.h, Filter::linear_8_bit); GPUs round only the positions. A sample
// near a step of the transfer function may then fall on the other side of the step; if many samples do, the
// exact image differs.
#pragma once

#include <cstdint>

#include "spu/volume/texture/texels.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Makes the request use rounded samples. Samples of colours, of pre-integration tables and on adaptive steps
/// stay exact.
void round_samples(volume::RenderRequest& request);

/// Returns whether a driver may round the samples of a texture.
bool may_be_rounded(const TextureDescription& texture);

/// Decides whether samples of a volume are exact or rounded: exact until a comparison with the viewer's own
/// image fails; then rounded, if that makes a comparison succeed.
class SampleRounding {
 public:
  bool rounds() const { return state_ == State::tried || state_ == State::adopted; }
  /// Returns whether rounding could explain a failed comparison.
  bool may_explain_loss(const TextureDescription& texture) const {
    return state_ == State::exact && may_be_rounded(texture);
  }
  /// Called after a failed comparison. Returns true if rounding could explain it: it is tried from the next
  /// image on.
  bool try_after_loss(const TextureDescription& texture);
  /// Excludes rounding as an explanation: the image with rounded samples is wrong as well.
  void refute() { state_ = State::refuted; }
  /// Called after a successful comparison of an image that shows something.
  void won() {
    if (state_ == State::tried) state_ = State::adopted;
  }

 private:
  enum class State : std::uint8_t { exact, tried, adopted, refuted };
  State state_ = State::exact;
};

}  // namespace understudy::spu
