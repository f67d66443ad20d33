// SPDX-License-Identifier: Apache-2.0
// `understudy view [-n N | --connect ADDRESS | --hostfile F] VOLUME`: a volume in a file to look at and to
// turn, in a browser or in a window, without OpenGL. Nodes read and render it; what stands here shows images
// and hears the hand.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_view(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
