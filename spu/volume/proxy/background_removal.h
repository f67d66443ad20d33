// SPDX-License-Identifier: Apache-2.0
// Programs that compose their samples by over, put the result over a background colour of their own and write
// the same alpha everywhere. Of n samples of one value such a fragment shows
//
//     background + (1 - T^n) (C - background)
//
// where T is the transparency of one sample and C the colour of so many that nothing shines through. So the
// opacity is how far along C - background, the contrast of the value, a fragment lies from the background. Rays
// whose samples have been counted tell that contrast.
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

/// Of one value.
struct BackgroundContrast {
  volume::Vec3 full{};  ///< C - background; zero for a value that shows nothing
  double alpha = 0;     ///< 1 - T

  bool visible() const { return full != volume::Vec3{}; }
};

volume::Vec3 colour_of(const volume::Rgba& rgba);

/// The contrast of a value that on rays of so many samples, in ascending order, shows these differences from
/// the background. Rays that hardly let light through are left out: programs may end them early.
BackgroundContrast contrast_of(std::span<const double> samples, std::span<const volume::Vec3> differences);

/// The opacity of a ray of one value that differs from the background by `difference`.
double opacity_of(const BackgroundContrast& contrast, const volume::Vec3& difference);

/// The same of a ray that has samples of two values. Null where both contrasts lie nearly along one line.
std::optional<double> opacity_of(const BackgroundContrast& one, const BackgroundContrast& other,
                                 const volume::Vec3& difference);

/// What a fragment's samples show by themselves, premultiplied, where they have that opacity.
volume::Rgba without_background(const ShaderBackground& background, double opacity,
                                const volume::Rgba& fragment);

/// The fragment of a ray whose samples show `ray`, premultiplied.
volume::Rgba over_background(const ShaderBackground& background, const volume::Rgba& ray);

}  // namespace understudy::spu
