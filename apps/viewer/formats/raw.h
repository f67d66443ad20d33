// SPDX-License-Identifier: Apache-2.0
// Reads raw voxels without a header; their size and type are given by the user or by the file's name.
#pragma once

#include <optional>
#include <string>

#include "apps/viewer/formats/volume_file.h"

namespace viewer {

/// Size and type in a name such as "engine.256x256x110", "a_64x64x32_uint16.raw" or "b.8x8x8.raw.gz".
struct NamedLayout {
  VolumeSize size;
  std::optional<ScalarType> type;
};
std::optional<NamedLayout> layout_in_name(const std::string& path);

/// The type is u8 unless the hints or the name specify another. The file must contain exactly the voxels.
Volume load_raw(const std::string& path, const VolumeHints& hints);

}  // namespace viewer
