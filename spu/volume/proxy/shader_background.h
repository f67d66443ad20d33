// SPDX-License-Identifier: Apache-2.0
// Whether a program puts its rays over a background colour of its own, told by fields of one value on the
// shortest rays: their colours go from the background towards the value's own in steps, each of which is
// shorter than the one before by the transparency of a sample. Nothing needs to be known of the program's
// steps.
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

/// Null where fragments are of another kind: their alpha varies, their samples are a sum, an extreme or nothing
/// that is known. `texels`: steps of one texel; `values`: all over the range.
std::optional<FoundBackground> find_background(FieldProbe& probe, const RaysThroughBox& rays,
                                               const volume::RaySteps& texels,
                                               const std::vector<float>& values);

/// Whether fragments of this alpha leave the program's own colour and nothing of what was there before.
bool hides_what_was_there(const Pipeline& pipeline, float alpha);

/// Shows `probe` the rays without the background that the program puts them over. Null: it does no such thing,
/// or its fragments do not replace what was there.
std::optional<ShaderBackground> remove_background(const MarchContext& measured, FieldProbe& probe,
                                                  const RaysThroughBox& rays);

/// The same of the background of `march`, where it has one; false where it is another now.
bool remove_known_background(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                             const March& march);

/// Values that have the colour of the program's background look as if they showed nothing, but may hide what
/// lies behind them, as fields tell that are opaque behind a plane. A few entries of march.table between others
/// that are seen are filled in; of more, these fields tell the opacity. False where that cannot be looked at.
/// `probe` shows rays without their background, whose samples lie on `steps`.
bool fill_unseen(FieldProbe& probe, const ProxyBox& box, const volume::RaySteps& steps, March& march);

}  // namespace understudy::spu
