// SPDX-License-Identifier: Apache-2.0
// `understudy view [-n N | --connect ADDRESS | --hostfile F] VOLUME`: displays a volume in a file and lets the
// user rotate it, in a browser or in a window, without OpenGL. Nodes read and render the volume; this folder
// displays images and handles input.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_view(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
