// SPDX-License-Identifier: Apache-2.0
// Colours of rays and of their samples: how samples make up a ray, by over, as a sum, or as an extreme.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "spu/volume/classification/colour_difference.h"
#include "spu/volume/proxy/march.h"
#include "volume/rgba.h"

namespace understudy::spu {

/// Returns the value at `place`, in [0,1], of a range.
float value_at(const std::array<float, 2>& range, double place);

/// Returns `count` values, evenly spread over the range.
std::vector<float> values_over(const std::array<float, 2>& range, int count = 128);

/// Whether a pixel has a fragment.
bool reached(const volume::Rgba& fragment);

/// Returns the colour of a fragment's ray, multiplied by alpha unless it is so `already`.
volume::Rgba premultiplied(volume::Rgba fragment, bool already);
/// Whether the program's fragments are already multiplied by alpha.
bool premultiplied_already(const MarchContext& measured, const March& march);

/// Whether blending multiplies colours by alpha, after they are clamped.
bool multiplies_by_alpha(const Pipeline& pipeline);

/// Whether colours grow in proportion to alpha from a short ray (`briefly`) to a long one (`through`) over the
/// same constant fields.
bool grow_with_alpha(const std::vector<volume::Rgba>& through, const std::vector<volume::Rgba>& briefly);
float brightest_channel(const volume::Rgba& colour);

/// Whether there is light under which constant fields are black: the table then holds colours of slopes.
bool is_black_where_even(const March& march);

/// Returns the colour that the march's table gives a sample in a constant field.
volume::Rgba even_sample(const March& march, float value);

/// Return one of `n` equal samples that make up `ray`, and the ray that `n` equal samples make up;
/// premultiplied.
volume::Rgba sample_of(const March& march, const volume::Rgba& ray, double n);
volume::Rgba ray_of(const March& march, const volume::Rgba& sample, double n);

/// Returns how much of a ray's samples is visible: from 0 to 1, or more for bright sums.
float amount(const March& march, const volume::Rgba& ray);

/// Returns the alpha that all these fragments have, if it is above 0; null if they differ.
std::optional<float> one_alpha(const std::vector<volume::Rgba>& through,
                               const std::vector<volume::Rgba>& briefly);

/// Returns the sum if a long ray (`through`) and a short one (`briefly`) over the same fields show that samples
/// are added up under one opacity; otherwise null.
std::optional<PlainSum> plain_sum(const std::vector<volume::Rgba>& through,
                                  const std::vector<volume::Rgba>& briefly);

}  // namespace understudy::spu
