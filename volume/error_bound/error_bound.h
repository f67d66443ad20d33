// SPDX-License-Identifier: Apache-2.0
// A certified bound of the error of an image against the volume rendering integral, for every pixel.
//
// The samples of the image cover whole rays (RaySteps::cover_whole_ray). A ray is divided into segments, one
// step long, with a sample in the middle of each. To bound the error with its sign, each segment is divided
// again: where the ray crosses faces of cells, and into parts of at most a quarter of a step. A part lies in
// one cell, where the field along the ray is a cubic. The parts' medium, sampled in their middles, composites
// to a finer image R' of the ray. The bound is
//
//     |image - R'|  +  a bound of |R' - R|
//
// for the integral R. In the first term the errors of an image cancel along a ray as they do in its pixel. Only
// the second term adds magnitudes: let R be the integral from a part on, t the transparency of the part and c
// the colour that it adds; primes denote the corresponding values of R'. Then
//
//     R_i - R'_i = (c_i - c'_i) + (t_i - t'_i) R'_(i+1) + t_i (R_(i+1) - R'_(i+1))
//
// so that a bound for R_i follows from one for R_(i+1), from the end of the ray to its beginning. With the
// plain colour X, c is the integral of X over opacity, and c' = X_m (1 - t') with X_m in the middle:
//
//     |(c - c') + (t - t') R'| <= |t - t'| |R' - X_m| + |integral of (X - X_m) over opacity|
//
// Both terms follow from how much the optical depth K and X may vary on a part. Let G bound the slope of the
// field along the part, and V its second derivative (field_variation.h). Over the values that the part may
// have, let k be the steepest slope of K, q its greatest curvature between kinks, and j the sum of its kinks
// (medium_variation.h). Then the difference between the depth and that of its middle is at most the least of
//
//     the range of K        k G / 4        k V / 24 + q G^2 / 24 + j (G + 2 V) / 8
//
// The last is the error of the midpoint rule, the integral of its Peano kernel over the changes of the
// derivative: where the field bends, where K bends, and where the field crosses a kink of K, at most three
// times, all but once with a slope of at most V. The same holds for X.
#pragma once

#include <memory>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/error_bound/field_variation.h"
#include "volume/raycast/brick_renderer.h"
#include "volume/request.h"

namespace understudy::volume {

class MediumVariation;

/// Draws requests whose `bound_of` is set, on the cells that a store owns. Data that depends only on the
/// texels, or on the last medium, is cached.
class ErrorBoundRenderer final : public BrickRenderer {
 public:
  /// `store` must outlive the renderer and be finished before the first render().
  explicit ErrorBoundRenderer(const BrickStore& store);
  ~ErrorBoundRenderer() override;
  ErrorBoundRenderer(ErrorBoundRenderer&&) noexcept;
  ErrorBoundRenderer& operator=(ErrorBoundRenderer&&) noexcept;

  void blocks_changed(std::span<const std::size_t> blocks) override;

 private:
  /// Throws std::invalid_argument for other requests, and as validate() does.
  void draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) override;

  const BrickStore* store_;
  std::unique_ptr<FieldVariation> variation_;
  MediumFunction medium_function_;
  Classification of_images_;
  std::unique_ptr<MediumVariation> medium_;
};

/// Computes bounds for a few pixels only: those in the centres of squares of `pixels_apart` x `pixels_apart`,
/// row by row, for as many whole squares as fit. The store must hold the whole volume; the window must be the
/// viewport, and begin at (0, 0). Throws as ErrorBoundRenderer does.
std::vector<float> error_bounds(const BrickStore& store, const FieldVariation& variation,
                                const RenderRequest& request, int pixels_apart);

}  // namespace understudy::volume
