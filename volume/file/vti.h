// SPDX-License-Identifier: Apache-2.0
// Image data of VTK in XML: appended (raw, base64) or inline (base64) data, in zlib blocks or as it is.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// By the name: .vti or .vti.gz.
bool is_vti(const std::string& path);

/// The active scalars of the points, or the first array of them that has one component; without one, those of
/// the cells. Throws FileError.
std::unique_ptr<VolumeFile> open_vti(const std::string& path, const ReadableFiles& files = {});

}  // namespace understudy::volume
