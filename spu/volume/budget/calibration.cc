// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/budget/calibration.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <utility>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/volume/timing/milliseconds_since.h"
#include "volume/footprint.h"
#include "volume/image.h"
#include "volume/raycast/segment_scene.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using volume::Image;
using volume::ImageView;
using volume::Pixel;
using volume::PixelIntegral;
using Clock = std::chrono::steady_clock;

/// In texels along the ray through the middle of the image, in the order of their trial. Below one texel,
/// samples are tried until two images in a row are similar enough; pre-integration tables take time to compute.
constexpr std::array coarse_samples{4.0, 2.0, 1.0};
constexpr std::array fine_samples{0.5, 0.25, 0.125, 0.0625, 0.03125};
constexpr std::array segments_apart{1.0, 0.5, 2.0, 0.25, 0.125};
/// The volume covers about this many pixels of the small image.
constexpr double small_image = 80.0 * 80.0;
/// Settings that can only save time are not tried after this.
constexpr double patience_ms = 400;
/// With a limit of the error, finer samples are tried until then: a slow or busy machine is to keep it, too.
constexpr double patience_for_an_error_ms = 5000;
constexpr double integrals_ms = 250;
constexpr std::size_t least_integrals = 64;
/// For integrals that are required: if they take longer, the nodes hang or are overloaded.
constexpr double patience_with_integrals_ms = 5000;
constexpr std::size_t spread_pixels = 64;
constexpr std::size_t worst_pixels = 8;  ///< of each setting

std::array<float, 4> pixel_of(const ImageView& image, const Pixel& pixel) {
  const volume::Rect& rect = image.rect;
  const int x = pixel.x - rect.x, y = pixel.y - rect.y;
  if (x < 0 || y < 0 || x >= rect.width || y >= rect.height) return {};
  const std::size_t at = 4 * (std::size_t(y) * std::size_t(rect.width) + std::size_t(x));
  return {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2], image.rgba[at + 3]};
}

/// The same camera with fewer pixels, and without opaque geometry: longer rays cost more, and err more.
volume::RenderRequest on_fewer_pixels(volume::RenderRequest request, int times) {
  request.depth.reset();
  if (times == 1) return request;
  request.viewport.width = std::max(1, request.viewport.width / times);
  request.viewport.height = std::max(1, request.viewport.height / times);
  const volume::Rect window = request.window;
  request.window = {request.viewport.x + (window.x - request.viewport.x) / times,
                    request.viewport.y + (window.y - request.viewport.y) / times,
                    std::max(1, window.width / times), std::max(1, window.height / times)};
  return request;
}

struct Tried {
  Setting setting;
  double ms = 0;
  Image image;
};

double greatest_difference(const ImageView& a, const ImageView& b) {
  const std::vector<Pixel> worst = most_different(a, b, 1);
  if (worst.empty()) return 0;
  const auto p = pixel_of(a, worst[0]), q = pixel_of(b, worst[0]);
  float most = 0;
  for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::abs(p[k] - q[k]));
  return double(most);
}

/// Returns the Pareto front: the settings for which no cheaper one is as exact.
std::vector<Measured> front_of(std::vector<Measured> all) {
  std::ranges::sort(all, {}, &Measured::ms);
  std::vector<Measured> front;
  for (const Measured& measured : all)
    if (front.empty() || measured.error < front.back().error) front.push_back(measured);
  return front;
}

}  // namespace

std::vector<Pixel> most_different(const ImageView& a, const ImageView& b, std::size_t count) {
  const volume::Rect rect = bounding(a.rect, b.rect);
  std::vector<std::pair<float, Pixel>> all;
  all.reserve(rect.pixels());
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const auto p = pixel_of(a, {x, y}), q = pixel_of(b, {x, y});
      float most = 0;
      for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::abs(p[k] - q[k]));
      if (most > 0) all.push_back({most, {x, y}});
    }
  count = std::min(count, all.size());
  std::ranges::partial_sort(all, all.begin() + std::ptrdiff_t(count), std::greater<>{},
                            &std::pair<float, Pixel>::first);
  std::vector<Pixel> worst;
  for (std::size_t i = 0; i < count; ++i) worst.push_back(all[i].second);
  return worst;
}

std::vector<Pixel> spread_over(const volume::Rect& rect, std::size_t first, std::size_t count) {
  // R2 sequence (Roberts 2018): multiples of inverse powers of the plastic number; any part of it is spread
  // evenly.
  constexpr double across = 0.7548776662466927, up = 0.5698402909980532;
  std::vector<Pixel> pixels;
  if (rect.empty()) return pixels;
  double whole = 0;
  for (std::size_t i = first; i < first + count; ++i)
    pixels.push_back({rect.x + int(std::modf(0.5 + across * double(i), &whole) * rect.width),
                      rect.y + int(std::modf(0.5 + up * double(i), &whole) * rect.height)});
  return pixels;
}

std::vector<PixelIntegral> integrals_of(compositor::ImageService& service, const volume::RenderRequest& request,
                                        std::span<const Pixel> pixels, std::size_t at_least, double usual_ms) {
  const auto start = Clock::now();
  std::vector<PixelIntegral> integrals;
  do {
    const auto more = service.integrals(request, pixels.subspan(integrals.size()), usual_ms);
    if (more.empty()) break;
    integrals.insert(integrals.end(), more.begin(), more.end());
  } while (integrals.size() < std::min(at_least, pixels.size()) &&
           milliseconds_since(start) < patience_with_integrals_ms);
  return integrals;
}

double greatest_error(const ImageView& image, std::span<const Pixel> pixels,
                      std::span<const PixelIntegral> integrals) {
  double greatest = 0;
  for (std::size_t i = 0; i < integrals.size(); ++i) {
    const auto shown = pixel_of(image, pixels[i]);
    for (std::size_t k = 0; k < 4; ++k)
      greatest = std::max(greatest, std::abs(double(shown[k]) - integrals[i][k]));
  }
  return greatest;
}

namespace {

/// The setting with samples `texels` apart; empty if the volume's ghost layer is too narrow for it.
std::optional<Setting> setting_of(const Meaning& meaning, const volume::VolumeDescription& volume,
                                  volume::Method method, double texels, float termination) {
  const Setting setting{method, texels / meaning.texels_a_step, termination};
  if (volume::ghost_layer_needed(volume, sampled_as(meaning, setting)) > volume.ghost_layer)
    return std::nullopt;
  return setting;
}

std::vector<Tried> tried_in_turn(compositor::ImageService& service, const Meaning& small,
                                 const volume::VolumeDescription& volume, float termination, double enough,
                                 int times) {
  const auto start = Clock::now();
  std::vector<Tried> tried;
  const auto try_out = [&](volume::Method method, double texels, double patience) {
    if (!tried.empty() && milliseconds_since(start) > patience) return;
    const auto setting = setting_of(small, volume, method, texels, termination);
    if (!setting) return;
    volume::RenderRequest request = sampled_as(small, *setting);
    service.render(request);  // prepares what depends on the transfer function alone
    request.termination = std::nextafter(request.termination, 1.0F);  // an equal request is not cast again
    const auto begin = Clock::now();
    const compositor::Rendered rendered = service.render(request);
    tried.push_back({*setting, milliseconds_since(begin) * times * times, copy_of(rendered.image)});
  };
  const double patience = enough > 0 ? patience_for_an_error_ms : patience_ms;
  for (const double texels : coarse_samples) try_out(volume::Method::post_classified, texels, patience);
  for (const double texels : fine_samples) {
    try_out(volume::Method::post_classified, texels, patience);
    const std::size_t last = tried.size() - 1;
    if (last > 0 && greatest_difference(tried[last - 1].image.view(), tried[last].image.view()) < enough) break;
  }
  for (const double texels : segments_apart) try_out(volume::Method::pre_integrated, texels, patience_ms);
  return tried;
}

/// For a service that loads parts for each image: renders all settings together, so that each part is loaded
/// once. Loading hides the time of casting, so the cost is the number of samples; a segment counts as two.
std::vector<Tried> tried_at_once(compositor::ImageService& service, const Meaning& small,
                                 const volume::VolumeDescription& volume, float termination) {
  std::vector<Tried> tried;
  std::vector<volume::RenderRequest> requests;
  const auto try_out = [&](volume::Method method, double texels, double samples) {
    const auto setting = setting_of(small, volume, method, texels, termination);
    if (!setting) return;
    requests.push_back(sampled_as(small, *setting));
    tried.push_back({*setting, samples / texels, {}});
  };
  for (const double texels : coarse_samples) try_out(volume::Method::post_classified, texels, 1);
  for (const double texels : fine_samples) try_out(volume::Method::post_classified, texels, 1);
  for (const double texels : segments_apart) try_out(volume::Method::pre_integrated, texels, 2);
  std::vector<Image> images = service.images(requests);
  for (std::size_t i = 0; i < tried.size(); ++i) tried[i].image = std::move(images[i]);
  return tried;
}

/// Compares images with integrals at the pixels where settings differ most, and at others spread over the
/// image.
std::vector<Measured> measured(compositor::ImageService& service, const Meaning& small,
                               const std::vector<Tried>& tried) {
  const ImageView finest =
      std::ranges::min_element(tried, {}, [](const Tried& one) { return one.setting.step; })->image.view();
  std::vector<Pixel> pixels;
  for (const Tried& one : tried) {
    const std::vector<Pixel> worst = most_different(one.image.view(), finest, worst_pixels);
    pixels.insert(pixels.end(), worst.begin(), worst.end());
  }
  const std::vector<Pixel> spread =
      spread_over(footprint(small.request, small.request.region), 0, spread_pixels);
  pixels.insert(pixels.end(), spread.begin(), spread.end());
  // If time is up before all are integrated, the missing ones must not all belong to the same settings.
  std::shuffle(pixels.begin(), pixels.end(), std::minstd_rand());
  const std::vector<PixelIntegral> integrals =
      integrals_of(service, small.request, pixels, least_integrals, integrals_ms);

  std::vector<Measured> all;
  all.reserve(tried.size());
  for (const Tried& one : tried)
    all.push_back({one.setting, greatest_error(one.image.view(), pixels, integrals), one.ms});
  return all;
}

}  // namespace

Calibration calibrate(compositor::ImageService& service, const Meaning& meaning,
                      const volume::VolumeDescription& volume, float termination, double enough) {
  const volume::Rect seen = footprint(meaning.request, meaning.request.region);
  const int times = std::max(1, int(std::lround(std::sqrt(double(seen.pixels()) / small_image))));
  const Meaning small{on_fewer_pixels(meaning.request, times), meaning.texels_a_step};
  const std::vector<Tried> tried = service.loads_for_images()
                                       ? tried_at_once(service, small, volume, termination)
                                       : tried_in_turn(service, small, volume, termination, enough, times);
  return {front_of(measured(service, small, tried))};
}

}  // namespace understudy::spu
