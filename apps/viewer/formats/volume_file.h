// SPDX-License-Identifier: Apache-2.0
// Reads a volume from a file, whatever its format.
//
// NRRD is known by its first bytes, NIfTI by its name (.nii .nii.gz .hdr .img); everything else is raw voxels,
// whose size and type come from the caller or from the name (engine.256x256x110, skull_256x256x256_uint8.raw).
// Raw files named
// *.gz are decompressed on the way.
#pragma once

#include <optional>
#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// What the user says about the file; it wins over what the file says itself.
struct VolumeHints {
  std::optional<VolumeSize> size;  ///< raw files only
  std::optional<ScalarType> type;  ///< raw files only
  bool big_endian = false;         ///< raw files only
  std::optional<Vec3> spacing;
};

/// Throws Error (bad_file) with the file, what is wrong with it and what to try.
Volume load_volume(const std::string& path, const VolumeHints& hints);

}  // namespace viewer
