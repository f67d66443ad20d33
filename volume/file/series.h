// SPDX-License-Identifier: Apache-2.0
// Time-dependent data: files that contain one time step each, or several.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace understudy::volume {

/// Most time steps that are accepted.
constexpr std::size_t max_time_steps = 100'000;

struct SeriesStep {
  std::string file;
  std::optional<int> in_file;  ///< the time step within a file of several, counted from 0
};

/// For display: the file's name without its folder, and the time step in it.
std::string name_of(const SeriesStep& step);

/// Expands `names` to files: they are paths, shell patterns ("step_*.vti", "step_[0-4]?.nrrd"), or synthetic
/// volumes. Names keep their order; the matches of a pattern are ordered by the numbers in their names, step_9
/// before step_10, and exclude folders. The name of an existing file is never treated as a pattern. Throws
/// FileError if a pattern has no matches.
std::vector<std::string> files_of_series(const std::vector<std::string>& names);

/// Whether `a` sorts before `b`: runs of digits are compared by value, everything else byte by byte.
bool comes_before(const std::string& a, const std::string& b);

}  // namespace understudy::volume
