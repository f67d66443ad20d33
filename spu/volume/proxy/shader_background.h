// SPDX-License-Identifier: Apache-2.0
// Detects a program that puts its rays over a background colour of its own, by constant fields on the shortest
// rays: their colours go from the background towards the value's own in steps, each of which is shorter than
// the one before by the transparency of a sample. The program's ray steps need not be known.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/proxy/background_removal.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/ray_probes.h"

namespace understudy::spu {

struct FoundBackground {
  ShaderBackground background;
  std::vector<CountedPlace> rays;  ///< shortest first, of one sample, two, three, and more
};

/// Null if fragments are of another kind: their alpha varies, or their samples are a sum, an extreme or nothing
/// that is known. `texels`: steps of one texel; `values`: spread over the range.
std::optional<FoundBackground> find_background(FieldProbe& probe, const RaysThroughBox& rays,
                                               const volume::RaySteps& texels,
                                               const std::vector<float>& values);

/// Whether fragments of this alpha leave nothing of what was there before.
bool hides_what_was_there(const Pipeline& pipeline, float alpha);

/// Makes `probe` return rays without the background that the program puts them over. Null if it has none, or if
/// its fragments do not replace what was there.
std::optional<ShaderBackground> remove_background(const MarchContext& measured, FieldProbe& probe,
                                                  const RaysThroughBox& rays);

/// Likewise for the background of `march`, if it has one; false if the background is another one now.
bool remove_known_background(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                             const March& march);

/// Values with the colour of the program's background look invisible, but may hide what lies behind them, as
/// fields that are opaque behind a plane reveal. Up to four such entries of march.table between visible ones
/// are interpolated; for others, these fields give the opacity. False if it cannot be measured. `probe` returns
/// rays without their background, whose samples lie on `steps`.
bool fill_unseen(FieldProbe& probe, const ProxyBox& box, const volume::RaySteps& steps, March& march);

}  // namespace understudy::spu
