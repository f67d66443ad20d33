// SPDX-License-Identifier: Apache-2.0
// What remains to be done with exported scenes (`run --export`) when the viewer has ended.
#pragma once

#include <filesystem>

#include "spu/report/report.h"

namespace understudy::launcher {

/// Writes the images of the scenes that this run exported to `folder` as PNG, over black, beside the float
/// images that the viewer's process wrote: that process contains no PNG library. Without any scene, prints why
/// none was exported. `run` is the private folder of the run.
void complete_exported_scenes(const std::filesystem::path& folder, const std::filesystem::path& run,
                              spu::Processes processes);

}  // namespace understudy::launcher
