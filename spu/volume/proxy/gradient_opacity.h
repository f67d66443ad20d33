// SPDX-License-Identifier: Apache-2.0
// Gradient opacity (Levoy 1988): a table that a program looks up by the length of a gradient, and by which it
// multiplies a sample's opacity. While everything else is measured, the table is white (FieldProbe), so that
// constant fields show something. Then it is read back; a table of coordinates in its place shows where in it a
// slope is looked up.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/refusal/refusal.h"
#include "volume/light.h"

namespace understudy::spu {

/// Gives each of `lights`, which may be the program's, its gradient opacity. `lit`: gradients change colours as
/// well; otherwise the space of gradients and their reach are measured here. `march` must have steps and a
/// table; how to check gradients later is stored in it.
std::optional<Refusal> measure_gradient_opacity(const MarchContext& measured, FieldProbe& probe,
                                                const ProxyBox& box, bool lit, March& march,
                                                std::vector<volume::Light>& lights);

/// Returns the gradient opacity of `march` with the factors that the program's table has now; null if it cannot
/// be read any more.
std::optional<volume::GradientOpacity> with_new_factors(const MarchContext& measured, const March& march);

/// Whether the march has gradient opacity.
bool fades_by_gradient(const March& march);

/// Whether slopes have the opacity that the light of `march` predicts.
bool still_fades_by_gradient(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                             const March& march);

}  // namespace understudy::spu
