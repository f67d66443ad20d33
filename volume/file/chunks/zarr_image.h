// SPDX-License-Identifier: Apache-2.0
// Which array of a Zarr folder is the volume, and what its axes are. OME-Zarr: ngff.openmicroscopy.org, up to
// 0.5.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/texture_space.h"

namespace understudy::volume {

enum class ZarrAxis : std::uint8_t { time, channel, z, y, x };

/// One level of an image, and what its axes are.
struct ZarrImage {
  std::string folder;  ///< of the array
  std::vector<ZarrAxis> axes;
  Vec3 spacing{1, 1, 1};
};

/// Whether a folder is an array or a group of Zarr, of any version.
bool is_zarr(const std::string& folder, const ReadableFiles& files);

/// The array at `level` of a multiscale image, or `folder` itself where it is an array. Throws FileError.
ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files);

}  // namespace understudy::volume
