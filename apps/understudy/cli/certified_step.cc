// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/certified_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "apps/understudy/study/median.h"
#include "compositor/rendered.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

/// A bound that is predicted to be as large as the error would often be a little larger.
constexpr double margin = 0.8;
/// Bounds near 1 hold for any image, and predict nothing: the next step is at least this much of the last one.
constexpr double least_ratio = 0.25;
/// The bound may fall more slowly than predicted: the next step is at most this much of the last one.
constexpr double largest_ratio = 0.7;

double next_step(double step, double bound, double error) {
  return step * std::clamp(std::sqrt(margin * error / bound), least_ratio, largest_ratio);
}

}  // namespace

BoundFigures bound_figures(const volume::ImageView& image) {
  std::vector<double> bounds;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    if (!(image.rgba[i] <= 0)) bounds.push_back(std::min(1.0, double(image.rgba[i])));  // no channel exceeds 1
  if (bounds.empty()) return {};
  return {*std::ranges::max_element(bounds), median(bounds), 0};
}

CertifiedStep certified_step(compositor::ImageService& service, const FileScene& scene,
                             const volume::TexelFigures& values, double error,
                             const std::function<void(double step, double bound)>& tried) {
  ImageSettings image = scene.image;
  const auto start = Clock::now();
  for (;;) {
    volume::RenderRequest request = request_of(scene, image, values);
    BoundFigures bound = bound_figures(service.render(request).image);
    tried(image.step, bound.greatest);
    if (bound.greatest <= error) {
      bound.time_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
      bound.asked = error;
      request.bound_of.reset();
      request.exact = true;
      return {image.step, std::move(request), bound};
    }
    if (image.step <= finest_certified_step)
      throw std::runtime_error(fmt::format(
          "the error bound is {:.3g} at a step of {:g} voxels, the finest that is tried: an error of {:.3g} "
          "cannot be "
          "certified; give a larger --error, or leave out --error-bound to keep the error by measuring it",
          bound.greatest, image.step, error));
    image.step = std::max(next_step(image.step, bound.greatest, error), finest_certified_step);
  }
}

}  // namespace understudy::launcher
