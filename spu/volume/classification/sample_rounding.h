// SPDX-License-Identifier: Apache-2.0
// Samples as drivers give them that filter 8-bit texels in 8 bits.
//
// llvmpipe rounds every filtered sample of such a texture to a whole number of 1/255 (graphics cards round the
// weights alone). Under a transfer function with steps a sample near a step then falls to its other side; where
// many do, the exact image is another one.
#pragma once

#include <cstdint>

#include "spu/volume/texture/texels.h"
#include "volume/classification.h"

namespace understudy::spu {

/// The transfer function that gives every sample the colour that `table` has for the nearest multiple of 1/255.
volume::TransferFunction with_rounded_samples(const volume::TransferFunction& table);

/// The same of a table of colours; others stay as they are.
void round_samples(volume::Classification& colours);

/// Whether a volume's samples are taken exactly or rounded: exactly, until a comparison with the viewer's own
/// image is lost; then rounded, if that comparison is won.
class SampleRounding {
 public:
  bool rounds() const { return state_ == State::tried || state_ == State::adopted; }
  /// A comparison was lost. True: rounding is another explanation, which is tried from the next image on.
  bool try_after_loss(const TextureDescription& texture);
  /// A comparison of an image that shows something was won.
  void won() {
    if (state_ == State::tried) state_ = State::adopted;
  }

 private:
  enum class State : std::uint8_t { exact, tried, adopted, refuted };
  State state_ = State::exact;
};

}  // namespace understudy::spu
