// SPDX-License-Identifier: Apache-2.0
// Volumes in TIFF files: the pages of one file, or the files of a folder with one slice each.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

/// Opens the pages of one file, at one time step and channel. Throws FileError.
std::unique_ptr<VolumeFile> open_tiff(const std::string& path, const FileHints& hints,
                                      const ReadableFiles& readable = {});

/// Opens `files` of one page each, with equal size and type, in slice order. `folder` is for messages. Throws
/// FileError.
std::unique_ptr<VolumeFile> open_tiff_stack(const std::string& folder, std::vector<std::string> files,
                                            const ReadableFiles& readable = {});

}  // namespace understudy::volume
