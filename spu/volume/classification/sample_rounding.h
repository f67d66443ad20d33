// SPDX-License-Identifier: Apache-2.0
// Samples as drivers give them that filter 8-bit texels in 8 bits.
//
// llvmpipe rounds the place of a sample to 1/256 of a texel, and every interpolation along an axis to a whole
// number of 1/255 (volume/texture_filter.h, Filter::linear_8_bit); graphics cards round the places alone. Under
// a transfer function with steps a sample near a step then falls to its other side; where many do, the exact
// image is another one.
#pragma once

#include <cstdint>

#include "spu/volume/texture/texels.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Asks for rounded samples. Samples of colours, of pre-integration tables and on adaptive steps stay as they
/// are.
void round_samples(volume::RenderRequest& request);

/// Whether a driver may round the samples of a texture.
bool may_be_rounded(const TextureDescription& texture);

/// Whether a volume's samples are taken exactly or rounded: exactly, until a comparison with the viewer's own
/// image is lost; then rounded, if that comparison is won.
class SampleRounding {
 public:
  bool rounds() const { return state_ == State::tried || state_ == State::adopted; }
  /// Whether rounding would be another explanation of a comparison that was lost.
  bool may_explain_loss(const TextureDescription& texture) const {
    return state_ == State::exact && may_be_rounded(texture);
  }
  /// A comparison was lost. True: rounding is another explanation, which is tried from the next image on.
  bool try_after_loss(const TextureDescription& texture);
  /// It is none: the image with rounded samples is wrong as well.
  void refute() { state_ = State::refuted; }
  /// A comparison of an image that shows something was won.
  void won() {
    if (state_ == State::tried) state_ = State::adopted;
  }

 private:
  enum class State : std::uint8_t { exact, tried, adopted, refuted };
  State state_ = State::exact;
};

}  // namespace understudy::spu
