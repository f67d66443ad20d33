// SPDX-License-Identifier: Apache-2.0
// `understudy convert VOLUME -o NAME.uvol`: converts a volume to a hierarchical one.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "volume/file/hierarchical_writer.h"

namespace understudy::launcher {

/// Returns what the command prints about the file: its size, and the error of each level.
std::string figures_text(const volume::HierarchyFigures& figures);

void add_convert(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
