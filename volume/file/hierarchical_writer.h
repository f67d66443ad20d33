// SPDX-License-Identifier: Apache-2.0
// Writes a hierarchical volume from any other one, on all cores.
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
  /// Largest error of any value; 0: lossless. For integers, an error below their scale has no effect.
  double max_error = 0;
  Prediction prediction = Prediction::cubic;
  int effort = 3;  ///< Zstandard's level, 1 to 19
};

struct HierarchyFigures {
  struct Level {
    std::array<int, 3> size{};
    std::uint64_t bytes = 0;  ///< of its blocks in the file
    double error = 0;         ///< in values: upper bound of the error of its trilinear interpolation
  };
  std::uint64_t scalar_bytes = 0;  ///< of the volume
  std::uint64_t file_bytes = 0;
  std::vector<Level> levels;  ///< from the finest on
};

/// Writes `path`, which gets its name only when it is complete. Memory: a seventh of the volume's scalars, plus
/// three times 64 slices. `progress` is called with the fraction of the work done, in [0,1]. Throws FileError.
HierarchyFigures write_hierarchical(VolumeFile& volume, const std::string& path,
                                    const HierarchyOptions& options,
                                    const std::function<void(double)>& progress = {});

}  // namespace understudy::volume
