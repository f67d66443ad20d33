// SPDX-License-Identifier: Apache-2.0
// Colours of rays and of their samples: how samples add up to a ray, by over, as a sum, or as an extreme.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "spu/volume/classification/colour_difference.h"
#include "spu/volume/proxy/march.h"
#include "volume/rgba.h"

namespace understudy::spu {

/// The value at `place` of a range, in [0,1].
float value_at(const std::array<float, 2>& range, double place);

/// `count` values, all over the range.
std::vector<float> values_over(const std::array<float, 2>& range, int count = 128);

/// Whether there was a fragment.
bool reached(const volume::Rgba& fragment);

/// The colour of a fragment's ray, multiplied by alpha.
volume::Rgba premultiplied(volume::Rgba fragment, bool already);
/// Whether the program's fragments are multiplied by alpha.
bool premultiplied_already(const MarchContext& measured, const March& march);

/// Whether blending multiplies colours by alpha, after they are clamped.
bool multiplies_by_alpha(const Pipeline& pipeline);

/// Whether colours grow in proportion to alpha from a short ray (`briefly`) to a long one (`through`) over the
/// same fields, each of one value.
bool grow_with_alpha(const std::vector<volume::Rgba>& through, const std::vector<volume::Rgba>& briefly);
float brightest_channel(const volume::Rgba& colour);

/// Whether there is light, and its table holds colours of slopes, since even fields are black.
bool is_black_where_even(const March& march);

/// What the march's table gives a sample in an even field.
volume::Rgba even_sample(const March& march, float value);

/// One of `n` equal samples that make up `ray`, and the ray that `n` equal samples make up; premultiplied.
volume::Rgba sample_of(const March& march, const volume::Rgba& ray, double n);
volume::Rgba ray_of(const March& march, const volume::Rgba& sample, double n);

/// How much of a ray's samples is seen: between nothing and 1, but for sums that shine brighter.
float amount(const March& march, const volume::Rgba& ray);

/// The alpha that all these fragments have, above 0; null where they differ.
std::optional<float> one_alpha(const std::vector<volume::Rgba>& through,
                               const std::vector<volume::Rgba>& briefly);

/// Samples that are added up under one opacity, as `through` and `briefly`, a long ray and a short one over the
/// same fields, show them.
std::optional<PlainSum> plain_sum(const std::vector<volume::Rgba>& through,
                                  const std::vector<volume::Rgba>& briefly);

}  // namespace understudy::spu
