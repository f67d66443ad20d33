// SPDX-License-Identifier: Apache-2.0
// Programs that compose their samples by over, put the result over a background colour of their own, and write
// the same alpha everywhere. For n samples of one value, such a fragment shows
//
//     background + (1 - T^n) (C - background)
//
// where T is the transparency of one sample and C the colour of so many samples that nothing shines through.
// The opacity is therefore how far the fragment lies from the background along C - background, the contrast of
// the value. Contrasts are measured on rays whose samples have been counted.
#pragma once

#include <optional>
#include <span>

#include "volume/rgba.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct ShaderBackground {
  volume::Vec3 colour{};
  float alpha = 1;  ///< of every fragment

  bool operator==(const ShaderBackground&) const = default;
};

/// A ray at normalised device coordinates (x, y), and how many samples it has.
struct CountedPlace {
  double x = 0;
  double y = 0;
  double samples = 0;
};

/// The contrast of one value.
struct BackgroundContrast {
  volume::Vec3 full{};  ///< C - background; zero for an invisible value
  double alpha = 0;     ///< 1 - T

  bool visible() const { return full != volume::Vec3{}; }
};

volume::Vec3 colour_of(const volume::Rgba& rgba);

/// Returns the contrast of a value, given its `differences` from the background on rays of `samples` samples,
/// in ascending order. Beyond the first three, rays of an opacity of 0.6 or more are ignored: programs may
/// terminate them early.
BackgroundContrast contrast_of(std::span<const double> samples, std::span<const volume::Vec3> differences);

/// Returns the opacity of a ray of one value that differs from the background by `difference`.
double opacity_of(const BackgroundContrast& contrast, const volume::Vec3& difference);

/// Likewise for a ray with samples of two values. Null if the two contrasts are nearly parallel.
std::optional<double> opacity_of(const BackgroundContrast& one, const BackgroundContrast& other,
                                 const volume::Vec3& difference);

/// Returns what a fragment's samples show by themselves, premultiplied, given their opacity.
volume::Rgba without_background(const ShaderBackground& background, double opacity,
                                const volume::Rgba& fragment);

/// Returns the fragment of a ray whose samples show `ray`, premultiplied.
volume::Rgba over_background(const ShaderBackground& background, const volume::Rgba& ray);

}  // namespace understudy::spu
