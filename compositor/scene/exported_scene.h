// SPDX-License-Identifier: Apache-2.0
// A scene that was recognised in an application, complete without it: the volume, the request for its image,
// and where both came from. The texels are in a file beside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "volume/description.h"
#include "volume/request.h"

namespace understudy::compositor {

constexpr int scene_format_version = 1;
/// Longest text of a scene. Values in images (depth, offsets of rays) take up to 25 bytes each.
constexpr std::size_t max_scene_bytes = std::size_t(1) << 28;

/// The message names the key and what is wrong with it.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct SceneOrigin {
  std::string program;         ///< the application's executable
  std::uint64_t frame = 0;     ///< counted from 1
  std::string texture_format;  ///< of the application, such as INTENSITY8
  std::optional<double> psnr;  ///< of its image against the application's own; unset: not compared, or equal
};

/// Ids and versions of volume and request are 1: they mean something in one process only.
struct ExportedScene {
  SceneOrigin origin;
  volume::VolumeDescription volume;
  std::string
      texels;  ///< file with all texels of `volume.size`, x fastest, little-endian, in the scene's folder
  volume::RenderRequest request;
};

/// Throws SceneError if a value is not finite, or the text would be too long.
std::string scene_text(const ExportedScene& scene);

/// Throws SceneError. Values are within the limits of messages (service/limits.h); volume::validate() has the
/// last word on the request.
ExportedScene scene_in(std::string_view text);

}  // namespace understudy::compositor
