// SPDX-License-Identifier: Apache-2.0
// A volume whose scalars lie in the memory of somebody else, and images of it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/images/image.h"
#include "compositor/service.h"
#include "volume/file/scalar_type.h"

namespace understudy::python {

/// Scalars tightly packed, x fastest, in native byte order. They outlive the volume, and do not change.
struct Scalars {
  std::span<const std::byte> bytes;
  volume::FileDescription description;
};

/// The render nodes do not answer; the next image asks for them again.
class NodesLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Not for two threads at once.
class ArrayVolume {
 public:
  /// Rendered in this process, or on the nodes behind `nodes`, a socket of `understudy serve`, for which it
  /// waits. Throws NodesLost.
  explicit ArrayVolume(const Scalars& scalars, const std::string& nodes = {});

  /// Premultiplied, with alpha. `control_points`, where it is not empty, is a transfer function as in a file,
  /// in place of the named one. What `arguments` says of a file is not looked at. Throws NodesLost, or
  /// std::exception with a sentence, as commands do.
  launcher::RgbaImage render(const launcher::SceneArguments& arguments, const std::string& control_points = {});

 private:
  void connect();
  void load(const launcher::FileScene& scene);
  launcher::RgbaImage render_with(const launcher::FileScene& scene);

  Scalars scalars_;
  std::string nodes_;
  std::unique_ptr<compositor::RenderService> service_;  ///< null: nodes that were lost
  std::optional<launcher::FileScene> loaded_;           ///< as it is with the service
  volume::TexelFigures figures_;
};

}  // namespace understudy::python
