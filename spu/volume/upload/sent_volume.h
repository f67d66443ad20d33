// SPDX-License-Identifier: Apache-2.0
// What the render service holds of one texture.
#pragma once

#include <array>
#include <cstdint>

#include "spu/volume/texture/texels.h"
#include "spu/volume/upload/block_hashes.h"
#include "volume/description.h"

namespace understudy::spu {

struct SentVolume {
  volume::VolumeDescription description;  ///< as the service holds it
  std::uint64_t generation = 0;           ///< of the service that holds it; 0: none
  std::uint64_t texture_version = 0;      ///< of the texture whose texels it holds
  BlockHashes hashes;                     ///< of the texels that it holds
  TextureDescription texture;
  std::array<float, 2> range{0, 1};  ///< of the texels' values
};

}  // namespace understudy::spu
