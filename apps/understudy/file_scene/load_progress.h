// SPDX-License-Identifier: Apache-2.0
// Progress of the ranks in reading a volume.
#pragma once

#include <span>
#include <string>

#include "apps/understudy/progress/progress.h"
#include "compositor/service/loading_service.h"

namespace understudy::launcher {

/// Returns the share of the texels that all ranks have read, 0 to 1.
double share_done(std::span<const compositor::RankLoad> ranks);

/// For example "loading  42 % [########            ] 110 MiB read by 4 ranks".
std::string progress_text(std::span<const compositor::RankLoad> ranks);
/// The same for part `part`, counted from 0, of `parts`: "part 2 of 5: loading …".
std::string progress_text(int part, int parts, std::span<const compositor::RankLoad> ranks);

/// Shows the progress; if it is shown in lines, with the bytes that each rank has read.
void show_load(Progress& progress, int part, int parts, std::span<const compositor::RankLoad> ranks);

}  // namespace understudy::launcher
