// SPDX-License-Identifier: Apache-2.0
// A volume whose scalars lie in the memory of somebody else, and images of it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/file_scene/file_scene.h"
#include "compositor/service.h"
#include "volume/file/scalar_type.h"

namespace understudy::python {

/// Scalars tightly packed, x fastest, in native byte order. They outlive the volume, and do not change.
struct Scalars {
  std::span<const std::byte> bytes;
  volume::FileDescription description;
};

/// Premultiplied RGBA, four floats a pixel, the top row first.
struct FloatImage {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;
};

class ArrayVolume {
 public:
  /// Rendered in this process, or on the nodes behind `nodes`, a socket of `understudy serve`, for which it
  /// waits. Throws compositor::ServiceLost.
  explicit ArrayVolume(const Scalars& scalars, const std::string& nodes = {});

  /// `control_points`, where it is not empty, is a transfer function as in a file, in place of the named one.
  /// What `arguments` says of a file is not looked at. Throws std::exception with a sentence, as commands do.
  FloatImage render(const launcher::SceneArguments& arguments, const std::string& control_points = {});

 private:
  void load(const launcher::FileScene& scene);

  Scalars scalars_;
  std::unique_ptr<compositor::RenderService> service_;
  std::optional<launcher::FileScene> loaded_;  ///< as it is with the service
  volume::TexelFigures figures_;
};

}  // namespace understudy::python
