// SPDX-License-Identifier: Apache-2.0
// VTK image data in XML: appended (raw, base64) or inline (base64) data, in zlib blocks or uncompressed.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// By the name: .vti or .vti.gz.
bool is_vti(const std::string& path);

/// Opens the active scalars of the points, or their first array with one component; if there is none, those of
/// the cells. Throws FileError.
std::unique_ptr<VolumeFile> open_vti(const std::string& path, const ReadableFiles& files = {});

}  // namespace understudy::volume
