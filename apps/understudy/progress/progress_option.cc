// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/progress/progress_option.h"

namespace understudy::launcher {

ProgressStyle ProgressOptions::style() const {
  if (quiet) return ProgressStyle::silent;
  return lines ? ProgressStyle::lines : usual_progress();
}

void add_progress_options(CLI::App& subcommand, ProgressOptions& options, const std::string& extra) {
  CLI::Option* progress = subcommand.add_flag(
      "--progress", options.lines, "print progress as separate lines, also where there is no terminal" + extra);
  subcommand.add_flag("--quiet", options.quiet, "print only warnings and errors")->excludes(progress);
}

}  // namespace understudy::launcher
