// SPDX-License-Identifier: Apache-2.0
// NIfTI-1 and NIfTI-2 volumes (.nii, .hdr with .img, each also .gz).
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// By the name.
bool is_nifti(const std::string& path);

/// Opens the volume at `time_step` along the fourth axis, and at index 0 of any further axis. Throws FileError.
std::unique_ptr<VolumeFile> open_nifti(const std::string& path, int time_step = 0,
                                       const ReadableFiles& files = {});

}  // namespace understudy::volume
