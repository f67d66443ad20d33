// SPDX-License-Identifier: Apache-2.0
// Light that shines from the eye along every ray, the default of ray casters, measured on what they draw.
//
// Over a linear field, all samples of a ray have one normal, and therefore one colour: that of the whole ray
// over its opacity. Depending on the angle between normal and ray, it is a multiple of the colour that the same
// value has in a constant field (ambient and diffuse light), plus a white part (specular light). Both are
// measured angle by angle, whatever the program's formula. If constant fields are black, because the material
// reflects no ambient light, the colour of a slope that faces the eye is used instead (facing_colours.h).
//
// The first and the last samples of a ray have other normals (ray_normals.h); the fewer texels the volume has,
// the more samples these are. Their contribution is removed once the reach of gradients is known.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "volume/light.h"

namespace understudy::spu {

/// Returns the light of `march`, whose steps and table are known, or why it is of another kind. Two lights if
/// no colour that was probed is bright enough to show whether the program clamps it. If constant fields are
/// black, the table gets colours.
std::variant<std::vector<volume::Light>, Refusal> measure_headlight(const MarchContext& measured,
                                                                    FieldProbe& probe, const ProxyBox& box,
                                                                    March& march);

/// The reason for the refusal of a program whose gradients serve something else than light.
inline constexpr const char* gradients_change_no_colour =
    "gradients are taken, but change no colour that is looked at";

/// Whether a ray over a few slopes looks as `march`, which has light, predicts.
bool still_lit(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, const March& march);

/// Whether gradients reach as far along `axes` as the light of `march` has it; axes that the ray does not show
/// pass.
bool gradients_still_reach(const MarchContext& measured, const ProxyBox& box, const March& march,
                           std::span<const std::size_t> axes);

}  // namespace understudy::spu
