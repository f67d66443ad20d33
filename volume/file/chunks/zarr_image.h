// SPDX-License-Identifier: Apache-2.0
// Finds the array of a Zarr folder that is the volume, and the meaning of its axes. OME-Zarr up to 0.5:
// ngff.openmicroscopy.org.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/texture_space.h"

namespace understudy::volume {

enum class ZarrAxis : std::uint8_t { time, channel, z, y, x };

/// One level of an image, and the meaning of its axes.
struct ZarrImage {
  std::string folder;  ///< of the array
  std::vector<ZarrAxis> axes;
  Vec3 spacing{1, 1, 1};
  int levels = 1;
  double scale = 1, offset = 0;  ///< a scalar s has the value scale * s + offset
};

/// The volume's axis (x: 0) of z, y or x.
constexpr std::size_t volume_axis(ZarrAxis axis) {
  return std::size_t(ZarrAxis::x) - std::size_t(axis);
}

/// Whether a folder is a Zarr array or group, of any version.
bool is_zarr(const std::string& folder, const ReadableFiles& files);

/// The array at `level` of a multiscale image, or `folder` itself if it is an array. Throws FileError.
ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files);

}  // namespace understudy::volume
