// SPDX-License-Identifier: Apache-2.0
// What nodes are asked to render for a march, and how their image is finished.
#include <algorithm>
#include <utility>

#include "spu/volume/classification/sample_rounding.h"
#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/ray_colours.h"
#include "volume/request.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Multiplies as blending does in a normalised framebuffer, which clamps colours first.
void multiply_by_alpha(volume::Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c)
      image.rgba[i + c] = std::min(image.rgba[i + c], 1.0F) * image.rgba[i + 3];
  }
}

void make_opaque_from(float limit, volume::Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    if (image.rgba[i] >= limit) image.rgba[i] = 1;
  }
}

/// Writes the value to the first channel; alpha counts samples. If the lowest value is invisible, blocks of
/// nothing else add nothing to a maximum. They do add to a minimum and a sum, so all values must be `visible`
/// then.
volume::TransferFunction ramp_over(const volume::TransferFunction& table, bool visible) {
  const Rgba& lowest = table.entries.front();
  visible |= std::any_of(lowest.begin(), lowest.end(), [](float x) { return x > 0; });
  volume::TransferFunction ramp;
  ramp.low = table.low;
  ramp.high = table.high;
  ramp.entries = {{0, 0, 0, visible ? 1.0F : 0.0F}, {1, 0, 0, 1}};
  return ramp;
}

/// Returns the mean of `sampled` samples whose colours, or values in the first channel, add up to `sum`.
Rgba mean_of(const March& march, const Rgba& sum, float sampled) {
  const volume::TransferFunction& table = march.table;
  if (march.mean == Mean::of_values)
    return table_at(table, table.low + sum[0] / sampled * (table.high - table.low));
  // All entries have the same alpha.
  const float alpha = table.entries.front()[3];
  return {sum[0] / sampled, sum[1] / sampled, sum[2] / sampled, alpha};
}

}  // namespace

void ask_nodes(const March& march, volume::RenderRequest& request) {
  request.steps = march.steps;
  if (march.extreme) {
    request.op = *march.extreme;
    request.classification = ramp_over(march.table, march.extreme == volume::Operator::min);
  } else if (march.mean == Mean::of_values) {
    request.op = volume::Operator::add;
    request.classification = ramp_over(march.table, true);
  } else {
    request.op = march.sum || march.mean ? volume::Operator::add : volume::Operator::over;
    volume::TransferFunction table = march.table;
    // Alpha counts the samples of a mean.
    for (Rgba& entry : table.entries) entry[3] = march.mean ? 1 : entry[3];
    request.classification = std::move(table);
    request.light = march.light;
    request.opacity_limit = march.opacity_limit;
    if (march.rounds_samples) round_samples(request);
  }
}

bool needs_finish(const March& march) {
  return march.shows_one_colour() || march.sum || march.alpha_twice || march.background ||
         march.opaque_at_limit;
}

void finish_image(const March& march, volume::Image& image) {
  if (march.background) return;  // put behind later, and only where the box covers pixels
  if (march.opaque_at_limit) make_opaque_from(march.opacity_limit, image);
  if (march.alpha_twice) multiply_by_alpha(image);
  if (march.alpha_twice || march.opaque_at_limit) return;
  const volume::TransferFunction& table = march.table;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    Rgba colour{};
    // Pixels without samples hold the operator's neutral value.
    const float sampled = image.rgba[i + 3];
    if (march.mean) {
      if (sampled > 0)
        colour = mean_of(march, {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], sampled}, sampled);
    } else if (march.sum) {
      // Alpha counts samples.
      if (sampled > 0) colour = ray_of(march, {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], 1}, 1);
    } else if (sampled > 0 && sampled <= 1) {
      colour = table_at(table, table.low + image.rgba[i] * (table.high - table.low));
    }
    std::copy(colour.begin(), colour.end(), image.rgba.begin() + std::ptrdiff_t(i));
  }
}

}  // namespace understudy::spu
