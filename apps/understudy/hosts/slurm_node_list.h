// SPDX-License-Identifier: Apache-2.0
// Parses the nodes of a Slurm allocation, in the form of SLURM_JOB_NODELIST: "gpu1,node[01-03,7]".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace understudy::launcher {

/// Returns every name, in order; none at all if the list is invalid (unclosed brackets, a bad
/// range, more than 4,096 names).
std::vector<std::string> slurm_nodes(std::string_view list);

}  // namespace understudy::launcher
