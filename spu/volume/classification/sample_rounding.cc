// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/sample_rounding.h"

#include <algorithm>
#include <variant>

#include "volume/request.h"

namespace understudy::spu {

void round_samples(volume::RenderRequest& request) {
  if (request.filter == volume::Filter::linear && request.method == volume::Method::post_classified &&
      std::holds_alternative<volume::TransferFunction>(request.classification))
    request.filter = volume::Filter::linear_8_bit;
}

bool may_be_rounded(const TextureDescription& texture) {
  // Drivers filter in float if there is a border.
  return texture.type == volume::TexelType::u8 && texture.filter == volume::Filter::linear &&
         std::find(texture.wrap.begin(), texture.wrap.end(), volume::Wrap::border) == texture.wrap.end();
}

bool SampleRounding::try_after_loss(const TextureDescription& texture) {
  if (state_ == State::tried) refute();
  if (!may_explain_loss(texture)) return false;
  state_ = State::tried;
  return true;
}

}  // namespace understudy::spu
