// SPDX-License-Identifier: Apache-2.0
// What nodes are asked to show for a march, and what their image becomes.
#include <algorithm>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/ray_colours.h"
#include "volume/request.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// As blending does in a normalised framebuffer, which clamps colours first.
void multiply_by_alpha(volume::Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c)
      image.rgba[i + c] = std::min(image.rgba[i + c], 1.0F) * image.rgba[i + 3];
  }
}

}  // namespace

void ask_nodes(const March& march, volume::RenderRequest& request) {
  request.steps = march.steps;
  if (!march.extreme) {
    request.op = march.sum ? volume::Operator::add : volume::Operator::over;
    request.classification = march.table;
    return;
  }
  request.op = *march.extreme;
  // The value travels in the first channel. Where the lowest one is invisible, blocks of nothing else add
  // nothing to a maximum; to a minimum they do.
  const Rgba& lowest = march.table.entries.front();
  const bool all_visible = march.extreme == volume::Operator::min ||
                           std::any_of(lowest.begin(), lowest.end(), [](float x) { return x > 0; });
  volume::TransferFunction ramp;
  ramp.low = march.table.low;
  ramp.high = march.table.high;
  ramp.entries = {{0, 0, 0, all_visible ? 1.0F : 0.0F}, {1, 0, 0, 1}};
  request.classification = ramp;
}

bool needs_finish(const March& march) {
  return march.extreme || march.sum || march.alpha_twice || march.background;
}

void finish_image(const March& march, volume::Image& image) {
  if (march.background) return;  // which only pixels have that the box covers
  if (march.alpha_twice) return multiply_by_alpha(image);
  const volume::TransferFunction& table = march.table;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    Rgba colour{};
    // Pixels without samples hold what changes no extreme.
    const float sampled = image.rgba[i + 3];
    if (march.sum) {
      // Alpha counts samples.
      if (sampled > 0) colour = ray_of(march, {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], 1}, 1);
    } else if (sampled > 0 && sampled <= 1) {
      colour = table_at(table, table.low + image.rgba[i] * (table.high - table.low));
    }
    std::copy(colour.begin(), colour.end(), image.rgba.begin() + std::ptrdiff_t(i));
  }
}

}  // namespace understudy::spu
