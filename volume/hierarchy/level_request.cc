// SPDX-License-Identifier: Apache-2.0
#include "volume/hierarchy/level_request.h"

#include "volume/hierarchy/level_grid.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::volume {

Box volume_in_level(const std::array<int, 3>& volume_size, int level) {
  const std::array<int, 3> size = LevelGrid(volume_size).size(level);
  const double apart = double(1 << level);
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = (-0.5 / apart + 0.5) / size[k];
    box.high[k] = ((volume_size[k] - 0.5) / apart + 0.5) / size[k];
  }
  return box;
}

void show_level(RenderRequest& request, const std::array<int, 3>& volume_size, int level) {
  request.region = volume_in_level(volume_size, level);
  Matrix4 to_volume = identity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double extent = request.region.high[k] - request.region.low[k];
    to_volume[5 * k] = 1 / extent;
    to_volume[4 * k + 3] = -request.region.low[k] / extent;
    for (std::size_t row = 0; row < 3; ++row) request.steps->metric[3 * row + k] /= extent;
  }
  request.texture_to_clip = multiply(request.texture_to_clip, to_volume);
}

}  // namespace understudy::volume
