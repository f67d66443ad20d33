// SPDX-License-Identifier: Apache-2.0
// A volume whose scalars are in memory owned by the caller, and images of it.
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

/// Tightly packed scalars, x fastest, in native byte order. They must outlive the volume and must not change.
struct Scalars {
  std::span<const std::byte> bytes;
  volume::FileDescription description;
};

/// The render nodes do not answer; the next image tries to connect again.
class NodesLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Not thread-safe.
class ArrayVolume {
 public:
  /// Renders in this process, or on the nodes behind `nodes`, a socket of `understudy serve`, for which
  /// it waits. Throws NodesLost.
  explicit ArrayVolume(const Scalars& scalars, const std::string& nodes = {});

  /// Returns a premultiplied image with alpha. `control_points`, unless empty, is a transfer function in the
  /// form of a file, and replaces the named one. Arguments that concern a file are ignored. Throws NodesLost,
  /// or std::exception with a message, as commands do.
  launcher::RgbaImage render(const launcher::SceneArguments& arguments, const std::string& control_points = {});

 private:
  void connect();
  void load(const launcher::FileScene& scene);
  launcher::RgbaImage render_with(const launcher::FileScene& scene);

  Scalars scalars_;
  std::string nodes_;
  std::unique_ptr<compositor::RenderService> service_;  ///< null after the nodes were lost
  std::optional<launcher::FileScene> loaded_;           ///< the scene whose volume the service holds
  volume::TexelFigures figures_;
};

}  // namespace understudy::python
