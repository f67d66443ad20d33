// SPDX-License-Identifier: Apache-2.0
// Raw scalars without a header: their size and type are told by the user or by the file's name.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// What a name such as "engine.256x256x110", "a_64x64x32_uint16be.raw" or "b.8x8x8_f32.raw.gz" says.
FileHints hints_in_name(const std::string& path);

/// The type is u8 and the byte order little-endian unless hints or name say another; the file must hold exactly
/// the scalars. Throws FileError.
std::unique_ptr<VolumeFile> open_raw(const std::string& path, const FileHints& hints,
                                     const ReadableFiles& files = {});

}  // namespace understudy::volume
