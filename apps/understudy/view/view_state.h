// SPDX-License-Identifier: Apache-2.0
// What one viewer has in sight: each browser window, and each window of its own, has its own.
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

  /// Throws MalformedView, with the state as it was, for a time step that there is not.
  void apply(const ViewMessage& message);

  const ViewCamera& camera() const { return camera_; }
  const ImageSettings& image() const { return image_; }
  bool still() const { return still_; }
  bool lossless() const { return still_ || lossless_moving_; }
  std::uint64_t sequence() const { return sequence_; }
  int time_step() const { return time_step_; }

  /// Of the image that is due: smaller while the camera moves, as far as its time asks for.
  std::array<int, 2> size() const;
  /// The image took so long to make. What the viewer says of the whole way to the eye counts more.
  void took(const std::array<int, 2>& size, double ms);

  /// The image that is due. Throws std::invalid_argument.
  volume::RenderRequest request(const FileScene& scene, const volume::TexelFigures& values) const;

  /// While it moves, an image is to take no longer.
  static constexpr double moving_ms = 50;

 private:
  void learn(double ms);

  ViewCamera camera_;
  ImageSettings image_;  ///< but for the camera
  volume::Light light_;  ///< when there is light
  bool still_ = true;
  bool lossless_moving_ = false;
  std::uint64_t sequence_ = 0;
  int time_step_;
  int time_steps_;  ///< how many there are
  std::array<int, 2> last_size_{};
  std::optional<double> ms_a_pixel_;  ///< smoothed
};

/// The ghost layer of texels that whatever a viewer may ask for needs; where the volume is smaller, that its
/// first image needs.
void widen_ghost_layer(FileScene& scene);

}  // namespace understudy::launcher
