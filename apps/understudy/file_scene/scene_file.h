// SPDX-License-Identifier: Apache-2.0
// A scene that `understudy run --export` has saved: read from its files, and sent to a render service.
#pragma once

#include <filesystem>
#include <string>

#include "compositor/scene/exported_scene.h"

namespace understudy::compositor {
class RenderService;
}

namespace understudy::launcher {

/// Whether the name is that of an exported scene, and not of a volume.
bool is_scene_file(const std::string& name);

struct SceneFile {
  compositor::ExportedScene scene;
  std::filesystem::path texels;
};

/// Reads the scene, and checks that the file of texels has the right size. Throws volume::FileError.
SceneFile read_scene_file(const std::filesystem::path& path);

/// Sends the volume. Throws volume::FileError, and what the service throws.
void send_scene(const SceneFile& file, compositor::RenderService& service);

}  // namespace understudy::launcher
