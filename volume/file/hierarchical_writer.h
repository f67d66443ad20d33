// SPDX-License-Identifier: Apache-2.0
// Makes a hierarchical volume out of any other one, on all cores.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "volume/file/volume_file.h"
#include "volume/hierarchy/interpolation.h"

namespace understudy::volume {

struct HierarchyOptions {
  /// No value may differ by more; 0: without loss. Of integers less than their scale has no effect.
  double max_error = 0;
  Prediction prediction = Prediction::cubic;
  int effort = 3;  ///< Zstandard's level, 1 to 19
};

struct HierarchyFigures {
  struct Level {
    std::array<int, 3> size{};
    std::uint64_t bytes = 0;  ///< of its blocks in the file
    double error = 0;         ///< in values: bound on what its trilinear interpolation differs by anywhere
  };
  std::uint64_t scalar_bytes = 0;  ///< of the volume
  std::uint64_t file_bytes = 0;
  std::vector<Level> levels;  ///< from the finest on
};

/// Writes `path`, which has its name once it is whole. Memory: a seventh of the volume's scalars, and 64 slices
/// of them three times. `progress` is called with parts of the work, in [0,1]. Throws FileError.
HierarchyFigures write_hierarchical(VolumeFile& volume, const std::string& path,
                                    const HierarchyOptions& options,
                                    const std::function<void(double)>& progress = {});

}  // namespace understudy::volume
