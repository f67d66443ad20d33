// SPDX-License-Identifier: Apache-2.0
// From the number of samples on many rays to the rule that places them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "volume/sampling.h"

namespace understudy::spu {

/// A ray's way through the box, in texture space, and how many samples lie on it.
struct CountedRay {
  volume::Vec3 way{};
  double samples = 0;
  int x = 0;  ///< the pixel, in the window
  int y = 0;
};

/// samples = round(|metric way| + offset), where |metric way| is the length of the way in steps.
struct StepFit {
  std::array<double, 9> metric{};
  double offset = 0;  ///< 1/2, 0 or -1/2
  /// The part of the rays whose count the fit does not explain by rounding: nothing when the rule is one of
  /// constant steps from the entry, much when rays start at places of their own (jitter) or are cut elsewhere.
  double unexplained = 1;
};

/// How long the axes of a texture are in texels.
constexpr volume::Vec3 axes_in_texels(const std::array<int, 3>& size) {
  return {double(size[0]), double(size[1]), double(size[2])};
}

/// More unexplained rays than that are no rounding.
constexpr double most_unexplained = 0.01;

/// The simplest fits that explain the counts: steps of one length in a space where the axes are as long as one
/// of `spaces` says (in texels, say), or, where no such step does, of a length along each axis, or in any
/// affine space. Rays of nearly one direction tell little of the other ones, and the simpler space is the one
/// that holds when the camera has moved. Several when the counts leave open where the first sample lies, or in
/// which space steps have one length; when nothing explains them, the best one; none without enough rays.
std::vector<StepFit> fit_steps(std::span<const CountedRay> rays, std::span<const volume::Vec3> spaces);

/// Whether both give every way nearly as many steps.
bool alike(const std::array<double, 9>& one, const std::array<double, 9>& other);

/// How many samples rays of the opacities 1 - q^n hold, for an unknown q: the counts n. Empty when the
/// opacities are not of that kind.
std::vector<double> counts_from_opacities(std::span<const double> opacities);

/// The same of amounts that grow by one sample's with every sample.
std::vector<double> counts_from_amounts(const std::vector<double>& amounts);

/// Rules that count as `fit` does: constant steps, and ways divided evenly, from their beginning or from the
/// middle of the first part.
std::vector<volume::RaySteps> rules_of(const StepFit& fit);

/// Rules that count as `fit` does, and whose samples do not end where the count does: of programs that take
/// int(L), ceil(L) or round(L) samples from the entry, from the middle of the first step or from its end.
std::vector<volume::RaySteps> rules_counting_ahead(const StepFit& fit);

/// The place of a first sample with which a ray that ends at its last sample has as many.
double counted_from(const volume::RaySteps& steps);

/// Length of a way in steps.
double steps_of_way(const volume::RaySteps& steps, const volume::Vec3& way);

/// Samples on a ray of so many steps.
double samples_of_length(const volume::RaySteps& steps, double length);

/// Places of the samples on a way, in parts of it.
std::vector<double> places_on_way(const volume::RaySteps& steps, const volume::Vec3& way);

}  // namespace understudy::spu
