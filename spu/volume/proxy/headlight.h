// SPDX-License-Identifier: Apache-2.0
// Light that shines from the eye along every ray, as ray casters have it by default, measured on what they
// draw.
//
// Over a field that rises evenly all samples of a ray have one normal, and so one colour: that of the whole ray
// over its opacity. By the angle between normal and ray it is a multiple of the colour that the same value has
// in an even field (ambient and diffuse light), and something white (specular light). Both are measured angle
// by angle, whatever the program's formula. Where even fields are black, because the material reflects no
// ambient light, the colour of a slope that faces the eye takes their place (facing_colours.h).
//
// The first and the last samples of a ray have other normals (ray_normals.h), the more of them the fewer texels
// the volume has. What they add is taken away once it is known how far gradients look.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "volume/light.h"

namespace understudy::spu {

/// What `march`, whose steps and table are known, needs to show the light; or why it is another light. Two
/// where no colour that is looked at is bright enough to tell whether the program clamps it. Where even fields
/// are black, the table gets colours.
std::variant<std::vector<volume::Light>, Refusal> measure_headlight(const MarchContext& measured,
                                                                    FieldProbe& probe, const ProxyBox& box,
                                                                    March& march);

/// The reason where a program's gradients are for something else than light.
inline constexpr const char* gradients_change_no_colour =
    "gradients are taken, but change no colour that is looked at";

/// Whether a ray over two slopes looks as `march`, which has light, says.
bool still_lit(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, const March& march);

/// Whether its gradients look as far along these axes as `march`, which has light, says, as far as a ray shows
/// it.
bool gradients_still_reach(const MarchContext& measured, const ProxyBox& box, const March& march,
                           std::span<const std::size_t> axes);

}  // namespace understudy::spu
