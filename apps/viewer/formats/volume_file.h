// SPDX-License-Identifier: Apache-2.0
// Reads a volume from a file of any supported format.
//
// NRRD is detected by its first bytes, NIfTI by its name (.nii .hdr .img, each also with .gz); every other file
// is raw voxels, whose size and type come from the caller or from the name (engine.256x256x110,
// skull_256x256x256_uint8.raw). Raw files named *.gz are decompressed.
#pragma once

#include <optional>
#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// What the user specifies about the file; takes precedence over the file itself.
struct VolumeHints {
  std::optional<VolumeSize> size;  ///< raw files only
  std::optional<ScalarType> type;  ///< raw files only
  bool big_endian = false;         ///< raw files only
  std::optional<Vec3> spacing;
};

/// Throws Error (bad_file) with the file, what is wrong with it and what to try.
Volume load_volume(const std::string& path, const VolumeHints& hints);

}  // namespace viewer
