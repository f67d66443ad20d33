// SPDX-License-Identifier: Apache-2.0
// Converts voxel values to texels: normalised to [0,1].
//
// u8 is unchanged (value/255). Other integers become 16-bit, with the volume's value range mapped to
// [0,1]. f32 is scaled to [0,1] by its finite range; values that are not finite become 0 and are
// counted, to be shown as empty.
#pragma once

#include "apps/viewer/model/volume.h"

namespace viewer {

enum class TexelFormat { unorm8, unorm16, float32 };

struct Texels {
  VolumeSize size{};
  Vec3 spacing{1, 1, 1};
  TexelFormat format = TexelFormat::unorm8;
  std::vector<std::byte> data;  ///< x fastest, no padding
  double value_at_0 = 0;        ///< the voxel value that became 0
  double value_at_1 = 255;      ///< the voxel value that became 1
  double lowest = 0;            ///< range of the finite values
  double highest = 0;
  std::int64_t not_finite = 0;  ///< NaN and infinite voxels
};

/// Consumes the volume (u8 voxels are not copied).
Texels to_texels(Volume volume);

/// Texel `index` in [0,1].
double texel_value(const Texels& texels, std::size_t index);

}  // namespace viewer
