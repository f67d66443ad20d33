// SPDX-License-Identifier: Apache-2.0
// Volumes in Zarr folders.
#pragma once

#include <memory>
#include <string>

#include "volume/file/readable_files.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

/// Opens an array, or a level of an OME-Zarr image, at one time step and channel. Throws FileError.
std::unique_ptr<VolumeFile> open_zarr(const std::string& folder, const FileHints& hints,
                                      const ReadableFiles& files = {});

}  // namespace understudy::volume
