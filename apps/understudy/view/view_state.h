// SPDX-License-Identifier: Apache-2.0
// The view of one user: each browser window has its own, and so has each window of the program.
#pragma once

#include <array>
#include <optional>

#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/view/camera.h"
#include "apps/understudy/view/view_message.h"
#include "volume/request.h"

namespace understudy::launcher {

class ViewState {
 public:
  explicit ViewState(const FileScene& scene);

  /// Throws MalformedView, with the state unchanged, if the time step does not exist.
  void apply(const ViewMessage& message);

  const ViewCamera& camera() const { return camera_; }
  const ImageSettings& image() const { return image_; }
  bool still() const { return still_; }
  bool lossless() const { return still_ || lossless_moving_; }
  std::uint64_t sequence() const { return sequence_; }
  int time_step() const { return time_step_; }

  /// Size of the next image: reduced while the camera moves, as far as its time requires.
  std::array<int, 2> size() const;
  /// Records the time to make an image. The time from input to display, as reported by
  /// the page, takes precedence.
  void took(const std::array<int, 2>& size, double ms);

  /// Makes the request for the next image. Throws std::invalid_argument.
  volume::RenderRequest request(const FileScene& scene, const volume::TexelFigures& values) const;

  /// Target time of an image while the camera moves.
  static constexpr double moving_ms = 50;

 private:
  void learn(double ms);

  ViewCamera camera_;
  ImageSettings image_;  ///< without the camera
  volume::Light light_;  ///< used when the light is on
  bool still_ = true;
  bool lossless_moving_ = false;
  std::uint64_t sequence_ = 0;
  int time_step_;
  int time_steps_;  ///< number of time steps
  std::array<int, 2> last_size_{};
  std::optional<double> ms_a_pixel_;  ///< exponentially smoothed
};

/// Widens the ghost layer to what any request of a viewer may need; if the volume is smaller than that, leaves
/// it at what the first image needs.
void widen_ghost_layer(FileScene& scene);

}  // namespace understudy::launcher
