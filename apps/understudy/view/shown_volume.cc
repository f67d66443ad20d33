#include "volume/brick/histogram.h"
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>

#include "apps/understudy/view/shown_volume.h"
#include "compositor/rendered.h"
#include "spu/volume/budget/calibration.h"
#include "volume/brick/histogram.h"
namespace understudy::launcher {
#include "volume/brick/histogram.h"
namespace {
#include "volume/brick/histogram.h"
using Clock = std::chrono::steady_clock;
#include "volume/brick/histogram.h"
/// Rays that are integrated of an image at rest, and what that may take.
#include "volume/brick/histogram.h"
constexpr std::size_t rays_at_once = 256;
#include "volume/brick/histogram.h"
constexpr double most_ms = 40;
#include "volume/brick/histogram.h"
bool has_integral(const volume::RenderRequest& request) {
#include "volume/brick/histogram.h"
  return request.op == volume::Operator::over && request.surfaces.empty() && !request.light &&
#include "volume/brick/histogram.h"
         request.cut_at_bricks == 0;
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
}  // namespace
#include "volume/brick/histogram.h"
void ShownVolume::load(const std::function<void(const std::vector<compositor::RankLoad>&)>& progress) {
#include "volume/brick/histogram.h"
  image_ = {};  // belongs to the service
#include "volume/brick/histogram.h"
  service_.reset();
#include "volume/brick/histogram.h"
  service_ = make_();
#include "volume/brick/histogram.h"
  std::vector<compositor::RankLoad> ranks = service_->begin_load(scene_.load);
#include "volume/brick/histogram.h"
  progress(ranks);
#include "volume/brick/histogram.h"
  while (!std::ranges::all_of(ranks, &compositor::RankLoad::done)) {
#include "volume/brick/histogram.h"
    ranks = service_->continue_load(scene_.load.volume.id);
#include "volume/brick/histogram.h"
    progress(ranks);
#include "volume/brick/histogram.h"
  }
#include "volume/brick/histogram.h"
  values_ = texel_figures(ranks);
#include "volume/brick/histogram.h"
  histogram_ = measured_histogram();
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
// Bins of integers are a whole number of them wide: where some had one more, they would stand out.
#include "volume/brick/histogram.h"
ShownVolume::Histogram ShownVolume::measured_histogram() {
#include "volume/brick/histogram.h"
  Histogram result;
#include "volume/brick/histogram.h"
  if (values_.low > values_.high) return result;
#include "volume/brick/histogram.h"
  const volume::TexelMapping& mapping = scene_.mapping;
#include "volume/brick/histogram.h"
  double low = values_.low, high = values_.high > low ? values_.high : low + 1;
#include "volume/brick/histogram.h"
  int count = volume::max_histogram_bins;
#include "volume/brick/histogram.h"
  if (mapping.type != volume::TexelType::f32) {
#include "volume/brick/histogram.h"
    const double unit = std::abs(mapping.scale);
#include "volume/brick/histogram.h"
    const double steps = std::round((high - low) / unit) + 1;
#include "volume/brick/histogram.h"
    const double width = std::max(1.0, std::ceil(steps / volume::max_histogram_bins));
#include "volume/brick/histogram.h"
    count = int(std::ceil(steps / width));
#include "volume/brick/histogram.h"
    low -= unit / 2;
#include "volume/brick/histogram.h"
    high = low + count * width * unit;
#include "volume/brick/histogram.h"
  }
#include "volume/brick/histogram.h"
  const double a = mapping.normalised(low), b = mapping.normalised(high);
#include "volume/brick/histogram.h"
  result.low = low;
#include "volume/brick/histogram.h"
  result.high = high;
#include "volume/brick/histogram.h"
  result.counts = service_->histogram(scene_.load.volume.id, {std::min(a, b), std::max(a, b), count});
#include "volume/brick/histogram.h"
  if (a > b) std::ranges::reverse(result.counts);  // texels fall where values rise
#include "volume/brick/histogram.h"
  return result;
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
ShownVolume::Drawn ShownVolume::draw(const ViewState& state) {
#include "volume/brick/histogram.h"
  request_ = state.request(scene_, values_);
#include "volume/brick/histogram.h"
  const Clock::time_point start = Clock::now();
#include "volume/brick/histogram.h"
  const compositor::Rendered rendered = service_->render(request_);
#include "volume/brick/histogram.h"
  image_ = rendered.image;
#include "volume/brick/histogram.h"
  return {over_black(image_, request_.window), request_, rendered.counts,
#include "volume/brick/histogram.h"
          std::chrono::duration<double, std::milli>(Clock::now() - start).count()};
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
std::optional<ShownVolume::Exactness> ShownVolume::exactness() {
#include "volume/brick/histogram.h"
  if (!has_integral(request_) || image_.rect.empty()) return std::nullopt;
#include "volume/brick/histogram.h"
  const std::vector<volume::Pixel> pixels = spu::spread_over(image_.rect, rays_looked_at_, rays_at_once);
#include "volume/brick/histogram.h"
  rays_looked_at_ += rays_at_once;
#include "volume/brick/histogram.h"
  const std::vector<volume::PixelIntegral> integrals = service_->integrals(request_, pixels, most_ms);
#include "volume/brick/histogram.h"
  return Exactness{spu::greatest_error(image_, std::span(pixels).first(integrals.size()), integrals),
#include "volume/brick/histogram.h"
                   integrals.size()};
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
std::vector<compositor::RankLoad> ShownVolume::ranks() {
#include "volume/brick/histogram.h"
  // The image of the service is valid until the next call but integrals().
#include "volume/brick/histogram.h"
  if (image_.rgba.data() != kept_.data()) {
#include "volume/brick/histogram.h"
    kept_.assign(image_.rgba.begin(), image_.rgba.end());
#include "volume/brick/histogram.h"
    image_.rgba = kept_;
#include "volume/brick/histogram.h"
  }
#include "volume/brick/histogram.h"
  return service_->continue_load(scene_.load.volume.id);
#include "volume/brick/histogram.h"
}
#include "volume/brick/histogram.h"
}  // namespace understudy::launcher
