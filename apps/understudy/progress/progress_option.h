// SPDX-License-Identifier: Apache-2.0
// `--progress` and `--quiet` of subcommands that may take long.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/understudy/progress/progress.h"

namespace understudy::launcher {

struct ProgressOptions {
  bool lines = false;
  bool quiet = false;  ///< neither progress nor a summary

  ProgressStyle style() const;
};

/// `extra` is appended to the help text of --progress: further content of its lines.
void add_progress_options(CLI::App& subcommand, ProgressOptions& options, const std::string& extra = {});

}  // namespace understudy::launcher
