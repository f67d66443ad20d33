// SPDX-License-Identifier: Apache-2.0
// From the numbers of samples on many rays to the rule that places them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "volume/sampling.h"

namespace understudy::spu {

/// A ray's path through the box, in texture space, and how many samples lie on it.
struct CountedRay {
  volume::Vec3 way{};
  double samples = 0;
  int x = 0;  ///< the pixel, in the window
  int y = 0;
};

/// samples = round(|metric way| + offset), where |metric way| is the length of the path in steps.
struct StepFit {
  std::array<double, 9> metric{};
  double offset = 0;  ///< 1/2, 0 or -1/2
  /// The fraction of the rays whose count rounding does not explain: nothing for a rule of constant steps from
  /// the entry, much if rays begin at places of their own (jitter) or are cut elsewhere.
  double unexplained = 1;
};

/// How long the axes of a texture are in texels.
constexpr volume::Vec3 axes_in_texels(const std::array<int, 3>& size) {
  return {double(size[0]), double(size[1]), double(size[2])};
}

/// A larger unexplained fraction is not due to rounding.
constexpr double most_unexplained = 0.01;

/// Returns the simplest fits that explain the counts: steps of one length in a space with the axis lengths of
/// one of `spaces` (in texels, for instance), or, if no such step does, steps of one length along each axis, or
/// in any affine space. Rays of nearly one direction say little about other directions, and the simpler space
/// is the one that holds when the camera has moved. Several fits if the counts leave open where the first
/// sample lies, or in which space steps have one length; the best one if nothing explains the counts; empty if
/// there are too few rays.
std::vector<StepFit> fit_steps(std::span<const CountedRay> rays, std::span<const volume::Vec3> spaces);

/// Whether both metrics give every path nearly the same number of steps.
bool alike(const std::array<double, 9>& one, const std::array<double, 9>& other);

/// Returns the numbers of samples n on rays of the opacities 1 - q^n, for an unknown q. Empty if the opacities
/// are not of that kind.
std::vector<double> counts_from_opacities(std::span<const double> opacities);

/// Likewise for amounts that grow by one sample's with every sample.
std::vector<double> counts_from_amounts(const std::vector<double>& amounts);

/// Returns rules with the counts of `fit`: constant steps, and paths divided evenly, with samples from the
/// beginning or from the middle of the first part.
std::vector<volume::RaySteps> rules_of(const StepFit& fit);

/// Returns rules with the counts of `fit` whose samples do not end where the count does: of programs that take
/// int(L), ceil(L) or round(L) samples from the entry, from the middle of the first step or from its end.
std::vector<volume::RaySteps> rules_counting_ahead(const StepFit& fit);

/// Returns the place of the first sample, in steps, by which samples are counted (RaySteps::counted_from).
double counted_from(const volume::RaySteps& steps);

/// Returns the length of a path in steps.
double steps_of_way(const volume::RaySteps& steps, const volume::Vec3& way);

/// Returns the number of samples on a ray of `length` steps.
double samples_of_length(const volume::RaySteps& steps, double length);

/// Returns the places of the samples on a path, as fractions of it; at least one.
std::vector<double> places_on_way(const volume::RaySteps& steps, const volume::Vec3& way);

}  // namespace understudy::spu
