// SPDX-License-Identifier: Apache-2.0
// A volume and its requests, for tests that compare services, and a launcher that steps its broker on a thread.
#pragma once

#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "compositor/service/broker.h"
#include "tests/compositor/scratch_folder.h"
#include "tests/volume/scenes.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor::testing {

using volume::testing::Texture;

/// 41 x 37 x 29 texels: no extent is a multiple of a block or of eight bytes.
inline Texture some_texture(volume::VolumeId id = 7, volume::TexelType type = volume::TexelType::u8) {
  volume::VolumeDescription description = volume::testing::describe({41, 37, 29}, type);
  description.id = id;
  return volume::testing::sampled(description, volume::testing::marschner_lobb_field());
}

inline volume::RenderRequest some_request(const Texture& texture,
                                          volume::Operator op = volume::Operator::over) {
  volume::RenderRequest request =
      volume::testing::request_for(texture, volume::testing::usual_camera(160, 120), 160, 120, 50);
  request.op = op;
  return request;
}

/// Samples one texel apart.
inline volume::RenderRequest request_on_steps(const Texture& texture) {
  volume::RenderRequest request = some_request(texture);
  request.steps.emplace();
  request.steps->metric = {40, 0, 0, 0, 36, 0, 0, 0, 28};
  return request;
}

/// For error bounds: a ghost layer that is wide enough for samples one texel apart.
inline Texture texture_for_bounds() {
  Texture texture = some_texture();
  texture.description.ghost_layer = 8;
  return texture;
}

/// The image of which holds error bounds.
inline volume::RenderRequest request_for_bounds(const Texture& texture) {
  volume::RenderRequest request = request_on_steps(texture);
  request.steps->first = 0.5;
  request.steps->cover_whole_ray = true;
  request.bound_of = {std::get<volume::TransferFunction>(request.classification), 1};
  return request;
}

/// Uploads slice ranges of three slices.
inline void upload(RenderService& service, const Texture& texture) {
  const volume::VolumeDescription& d = texture.description;
  service.begin_volume(d);
  const int slices = d.stored.high[2] - d.stored.low[2];
  const std::size_t slice_bytes = texture.texels.size() / std::size_t(slices);
  for (int z = 0; z < slices; z += 3) {
    const int now = std::min(3, slices - z);
    volume::TexelBox slice_range = d.stored;
    slice_range.low[2] += z;
    slice_range.high[2] = slice_range.low[2] + now;
    service.add_texels(
        d.id, {&slice_range, 1},
        std::span(texture.texels).subspan(std::size_t(z) * slice_bytes, std::size_t(now) * slice_bytes));
  }
  service.end_volume(d.id);
}

/// Copies an image, over the request's whole window: it outlives the next call, and can be compared.
inline volume::Image whole_image(const Rendered& rendered, const volume::RenderRequest& request) {
  volume::Image image(request.window);
  const float neutral = request.op == volume::Operator::min ? std::numeric_limits<float>::max() : 0.0F;
  std::ranges::fill(image.rgba, neutral);
  const volume::Rect& rect = rendered.image.rect;
  for (int y = 0; y < rect.height; ++y)
    std::ranges::copy(
        rendered.image.rgba.subspan(4 * std::size_t(y) * std::size_t(rect.width), 4 * std::size_t(rect.width)),
        image.at(rect.x, rect.y + y));
  return image;
}

inline volume::Image image_of(RenderService& service, const volume::RenderRequest& request) {
  return whole_image(service.render(request), request);
}

inline double largest_difference(const volume::Image& a, const volume::Image& b) {
  return a.rect == b.rect ? volume::testing::difference(a, b).max : 1e300;
}

/// The nodes' socket, beside that of applications.
inline std::string socket_of_nodes(const std::string& path) {
  return path + ".nodes";
}

/// The launcher, on a thread of its own.
class Launcher {
 public:
  explicit Launcher(const std::string& path, const BrokerPatience& patience = {})
      : broker_(
            {path, socket_of_nodes(path)}, [this](const std::string& line) { said_.push_back(line); },
            patience),
        thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            const std::lock_guard lock(mutex_);
            broker_.step(std::chrono::milliseconds(1));
          }
        }) {}

  template <class Ask>
  auto ask(Ask ask) {
    const std::lock_guard lock(mutex_);
    return ask(broker_);
  }
  std::vector<std::string> said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  bool wait_for_group() {
    return eventually([&] { return ask([](Broker& b) { return b.node_group_ready(); }); });
  }
  bool wait_for_loss() {
    return eventually([&] { return ask([](Broker& b) { return b.lost(); }); });
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> said_;
  Broker broker_;
  std::jthread thread_;
};

}  // namespace understudy::compositor::testing
