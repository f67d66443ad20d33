// SPDX-License-Identifier: Apache-2.0
// The nodes of a Slurm allocation, as SLURM_JOB_NODELIST has them: "gpu1,node[01-03,7]".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace understudy::launcher {

/// Every name, in order. What cannot be understood (brackets that do not close, a range that is none, more than
/// 4,096 names) gives no name at all.
std::vector<std::string> slurm_nodes(std::string_view list);

}  // namespace understudy::launcher
