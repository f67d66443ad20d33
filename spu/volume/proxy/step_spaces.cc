// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/step_spaces.h"

#include "spu/volume/proxy/axis_lengths.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

std::vector<volume::Vec3> step_spaces(const std::array<int, 3>& size, const volume::Matrix4& texture_to_clip,
                                      const FieldProbe& probe) {
  std::vector<volume::Vec3> spaces{axes_in_texels(size)};
  if (const auto lengths = axis_lengths(texture_to_clip, probe.width(), probe.height()))
    spaces.push_back(*lengths);
  spaces.push_back({1, 1, 1});
  return spaces;
}

}  // namespace understudy::spu
