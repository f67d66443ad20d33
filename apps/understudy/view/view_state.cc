// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/view_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volume/raycast/segment_scene.h"

namespace understudy::launcher {
namespace {

/// The light if none was given on the command line: from the eye, on everything.
volume::Light usual_light(const FileScene& scene) {
  ShadingArguments arguments;
  arguments.light = "all";
  return *shading_of(arguments, scene.extent()).light;
}

/// Largest factor by which a side of an image is reduced.
constexpr double coarsest = 6;

}  // namespace

ViewState::ViewState(const FileScene& scene)
    : camera_{scene.image.camera, {}},
      image_(scene.image),
      light_(scene.image.shading.light.value_or(usual_light(scene))),
      time_step_(scene.time_step),
      time_steps_(std::max(1, int(scene.series.size()))) {}

void ViewState::apply(const ViewMessage& message) {
  if (message.time_step && *message.time_step >= time_steps_)
    throw MalformedView(fmt::format("'time_step' must be less than {}", time_steps_));
  time_step_ = message.time_step.value_or(time_step_);
  sequence_ = message.sequence;
  still_ = message.still;
  if (message.lossless) lossless_moving_ = *message.lossless;
  if (message.took_ms) learn(*message.took_ms);
  if (message.size) {
    image_.width = (*message.size)[0];
    image_.height = (*message.size)[1];
  }
  if (message.camera) camera_ = *message.camera;
  if (message.rotate) camera_ = rotated(camera_, (*message.rotate)[0], (*message.rotate)[1]);
  if (message.pan) camera_ = panned(camera_, *message.pan);
  if (message.zoom) camera_ = zoomed(camera_, message.zoom->by, message.zoom->at);
  if (message.table) image_.control_points = *message.table;
  Shading& shading = image_.shading;
  if (message.shows_volume) shading.shows_volume = *message.shows_volume;
  if (message.surfaces) shading.surfaces = *message.surfaces;
  if (message.light) shading.light = *message.light ? std::optional(light_) : std::nullopt;
  if (message.step) image_.step = *message.step;
}

std::array<int, 2> ViewState::size() const {
  const std::array<int, 2> whole{image_.width, image_.height};
  if (still_ || !ms_a_pixel_) return whole;
  const double ms = *ms_a_pixel_ * image_.width * image_.height;
  if (ms <= moving_ms) return whole;
  const double by = std::min(coarsest, std::sqrt(ms / moving_ms));
  return {std::max(1, int(image_.width / by)), std::max(1, int(image_.height / by))};
}

void ViewState::took(const std::array<int, 2>& size, double ms) {
  last_size_ = size;
  if (!ms_a_pixel_) learn(ms);
}

void ViewState::learn(double ms) {
  const double pixels = double(last_size_[0]) * last_size_[1];
  if (pixels == 0) return;
  constexpr double weight = 0.3;
  ms_a_pixel_ = ms_a_pixel_ ? *ms_a_pixel_ + weight * (ms / pixels - *ms_a_pixel_) : ms / pixels;
}

volume::RenderRequest ViewState::request(const FileScene& scene, const volume::TexelFigures& values) const {
  ImageSettings image = image_;
  image.camera = camera_.orbit;
  const std::array<int, 2> now = size();
  image.width = now[0];
  image.height = now[1];
  Shading& shading = image.shading;
  if (!shading.surfaces.empty() || shading.light) {
    // Surfaces and light require `over`, with samples or segments.
    shading.op = volume::Operator::over;
    if (shading.method == volume::Method::adaptive) shading.method = volume::Method::post_classified;
  }
  volume::RenderRequest request = request_of(scene, image, values);
  shift(request, camera_.shift);
  request.exact = still_;  // it is shown without loss, and compared with the integral
  return request;
}

void widen_ghost_layer(FileScene& scene) {
  ImageSettings widest = scene.image;
  widest.step = std::max(widest.step, most_view_step);
  widest.shading.op = volume::Operator::over;
  widest.shading.method = volume::Method::pre_integrated;
  widest.shading.light = usual_light(scene);
  widest.shading.surfaces = {SurfaceChoice{}};
  const int ghost_layer = volume::ghost_layer_needed(scene.load.volume, unclassified_request(scene, widest));
  if (ghost_layer <= *std::ranges::max_element(scene.file.size))
    scene.load.volume.ghost_layer = std::max(scene.load.volume.ghost_layer, ghost_layer);
}

}  // namespace understudy::launcher
