// SPDX-License-Identifier: Apache-2.0
// Raw scalars without a header: the user or the file's name specifies their size and type.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// The hints in names such as "engine.256x256x110", "a_64x64x32_uint16be.raw" or "b.8x8x8_f32.raw.gz".
FileHints hints_in_name(const std::string& path);

/// Defaults are u8 and little-endian, unless hints or name specify otherwise; the file must contain exactly the
/// scalars. Throws FileError.
std::unique_ptr<VolumeFile> open_raw(const std::string& path, const FileHints& hints,
                                     const ReadableFiles& files = {});

}  // namespace understudy::volume
