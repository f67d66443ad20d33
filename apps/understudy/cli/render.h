// SPDX-License-Identifier: Apache-2.0
// `understudy render VOLUME [-n N] --out P.png`: renders an image of a volume file on nodes or in this process,
// without a viewer and without OpenGL.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_render(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
