// SPDX-License-Identifier: Apache-2.0
// MetaImage volumes, as written by ITK, 3D Slicer and elastix: header and data in one file (.mha) or in two
// (.mhd with .raw or .zraw). itk.org/Wiki/ITK/MetaIO/Documentation.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// By the name.
bool is_meta_image(const std::string& path);

/// Opens a scalar volume of two or three axes, at `time_step` along a fourth one. Throws FileError.
std::unique_ptr<VolumeFile> open_meta_image(const std::string& path, int time_step = 0,
                                            const ReadableFiles& files = {});

}  // namespace understudy::volume
