// SPDX-License-Identifier: Apache-2.0
// `understudy render FOLDER/scene.json`: the image of a scene that `understudy run --export` has saved.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"

namespace understudy::launcher {

struct SceneToRender {
  std::string scene;
  std::string out;         ///< PNG
  std::string save_float;  ///< PFM; empty: none
  int frames = 1;
  bool quiet = false;
};

/// Throws std::invalid_argument if an option was given that would change the scene, or concerns other volumes.
void refuse_options_with_scene(const CLI::App& render_command);

/// Throws std::runtime_error.
int render_scene(const SceneToRender& what, const LoadingNodes& nodes);

}  // namespace understudy::launcher
