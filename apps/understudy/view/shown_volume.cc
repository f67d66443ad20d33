// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/shown_volume.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "compositor/rendered.h"
#include "spu/volume/budget/calibration.h"
#include "volume/brick/histogram.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

/// Number of rays that are integrated at once to check an image at rest, and the time limit.
constexpr std::size_t rays_at_once = 256;
constexpr double most_ms = 40;

bool has_integral(const volume::RenderRequest& request) {
  return request.op == volume::Operator::over && request.surfaces.empty() && !request.light &&
         request.cut_at_bricks == 0;
}

}  // namespace

void ShownVolume::load(const std::function<void(const std::vector<compositor::RankLoad>&)>& progress) {
  image_ = {};  // its pixels belong to the service
  steps_.reset();
  service_.reset();
  service_ = make_();
  steps_.emplace(*service_, scene_, memory_(std::max(1, service_->nodes())));
  std::vector<compositor::RankLoad> ranks;
  steps_->show(scene_.time_step, [&](const std::vector<compositor::RankLoad>& now) {
    ranks = now;
    progress(now);
  });
  values_ = texel_figures(ranks);
  if (const auto& values = scene_.file.values) {
    values_.low = (*values)[0];
    values_.high = (*values)[1];
  }
  histogram_ = measured_histogram();
}

// For integers, all bins have the same integer width: bins with one more value would stand out.
ShownVolume::Histogram ShownVolume::measured_histogram() {
  Histogram result;
  if (values_.low > values_.high) return result;
  const volume::TexelMapping& mapping = scene_.mapping;
  double low = values_.low, high = values_.high > low ? values_.high : low + 1;
  int count = volume::max_histogram_bins;
  if (mapping.type != volume::TexelType::f32) {
    const double unit = std::abs(mapping.scale);
    const double steps = std::round((high - low) / unit) + 1;
    const double width = std::max(1.0, std::ceil(steps / volume::max_histogram_bins));
    count = int(std::ceil(steps / width));
    low -= unit / 2;
    high = low + count * width * unit;
  }
  const double a = mapping.normalised(low), b = mapping.normalised(high);
  result.low = low;
  result.high = high;
  result.counts =
      service_->histogram(steps_->volume_of(*steps_->shown()), {std::min(a, b), std::max(a, b), count});
  if (a > b) std::ranges::reverse(result.counts);  // texels decrease with increasing values
  return result;
}

ShownVolume::Drawn ShownVolume::draw(const ViewState& state, const TimeSteps::Progress& progress) {
  image_ = {};
  const Clock::time_point start = Clock::now();
  steps_->show(state.time_step(), progress);
  request_ = state.request(scene_, values_);
  request_.volume = steps_->volume_of(state.time_step());
  const Clock::time_point loaded = Clock::now();
  const compositor::Rendered rendered = service_->render(request_);
  image_ = rendered.image;
  return {over_black(image_, request_.window), request_, rendered.counts,
          std::chrono::duration<double, std::milli>(Clock::now() - loaded).count(),
          std::chrono::duration<double, std::milli>(loaded - start).count()};
}

bool ShownVolume::read_ahead(std::span<const int> in_use) {
  if (scene_.series.size() < 2) return false;
  image_ = {};
  return steps_->read_ahead(in_use);
}

std::optional<ShownVolume::Exactness> ShownVolume::exactness() {
  if (!has_integral(request_) || image_.rect.empty()) return std::nullopt;
  const std::vector<volume::Pixel> pixels = spu::spread_over(image_.rect, rays_looked_at_, rays_at_once);
  rays_looked_at_ += rays_at_once;
  const std::vector<volume::PixelIntegral> integrals = service_->integrals(request_, pixels, most_ms);
  return Exactness{spu::greatest_error(image_, std::span(pixels).first(integrals.size()), integrals),
                   integrals.size()};
}

std::vector<compositor::RankLoad> ShownVolume::ranks() {
  // The service's image is valid only until the next call other than integrals().
  if (image_.rgba.data() != kept_.data()) {
    kept_.assign(image_.rgba.begin(), image_.rgba.end());
    image_.rgba = kept_;
  }
  return service_->continue_load(request_.volume);
}

}  // namespace understudy::launcher
