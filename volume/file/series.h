// SPDX-License-Identifier: Apache-2.0
// Time-dependent data: files that hold one time step each, or several.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace understudy::volume {

/// Most time steps that are believed.
constexpr std::size_t max_time_steps = 100'000;

struct SeriesStep {
  std::string file;
  std::optional<int> in_file;  ///< of a file with several time steps: which, counted from 0
};

/// For people: the file's name without its folder, and which of its time steps.
std::string name_of(const SeriesStep& step);

/// The files that `names` mean, which are paths, patterns as the shell has them ("step_*.vti",
/// "step_[0-4]?.nrrd"), or synthetic volumes. Names keep their order; what a pattern means comes in the order
/// of the numbers in the names, step_9 before step_10, without folders. A name that is there means itself,
/// whatever is in it. Throws FileError where a pattern means nothing.
std::vector<std::string> files_of_series(const std::vector<std::string>& names);

/// Whether `a` comes before `b`: runs of digits by their value, all else byte by byte.
bool comes_before(const std::string& a, const std::string& b);

}  // namespace understudy::volume
