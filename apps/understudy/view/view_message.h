// SPDX-License-Identifier: Apache-2.0
// Requests of a page, as JSON text (README.md lists the keys). The sender is untrusted: every length and every
// number is checked against a limit.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "apps/understudy/file_scene/shading_options.h"
#include "apps/understudy/view/camera.h"
#include "volume/transfer_control_points.h"

namespace understudy::launcher {

constexpr std::size_t max_view_message_bytes = std::size_t(256) << 10U;  ///< holds as many control points
constexpr int least_view_side = 16;
constexpr int most_view_side = 4096;
constexpr std::size_t max_view_control_points = 1024;
constexpr double least_view_step = 0.25;  ///< voxels
constexpr double most_view_step = 4;

/// The message is invalid; the text says which key, and what is wrong with it.
class MalformedView : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Missing keys leave the state unchanged.
struct ViewMessage {
  std::uint64_t sequence = 0;     ///< returned with the image
  bool still = true;              ///< whether the camera is at rest
  std::optional<bool> lossless;   ///< also while the camera moves
  std::optional<double> took_ms;  ///< time from input to display of the last image
  std::optional<std::array<int, 2>> size;
  std::optional<ViewCamera> camera;
  std::optional<std::array<ImagePoint, 2>> rotate;  ///< from and to
  std::optional<ImagePoint> pan;
  struct Zoom {
    double by = 1;
    ImagePoint at{};
  };
  std::optional<Zoom> zoom;
  std::optional<volume::TransferControlPoints> table;
  std::optional<bool> shows_volume;
  std::optional<std::vector<SurfaceChoice>> surfaces;  ///< positions are relative to the range of values
  std::optional<bool> light;
  std::optional<double> step;    ///< voxels
  std::optional<int> time_step;  ///< time step of a series, counted from 0
};

/// Throws MalformedView.
ViewMessage decode_view_message(std::string_view text);

}  // namespace understudy::launcher
