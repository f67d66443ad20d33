// SPDX-License-Identifier: Apache-2.0
// Raw voxels without a header; their size and type are told by the user or by the file's name.
#pragma once

#include <optional>
#include <string>

#include "apps/viewer/formats/volume_file.h"

namespace viewer {

/// What a name such as "engine.256x256x110", "a_64x64x32_uint16.raw" or "b.8x8x8.raw.gz" says.
struct NamedLayout {
  VolumeSize size;
  std::optional<ScalarType> type;
};
std::optional<NamedLayout> layout_in_name(const std::string& path);

/// Type is u8 unless the hints or the name tell another; the file must hold exactly the voxels.
Volume load_raw(const std::string& path, const VolumeHints& hints);

}  // namespace viewer
