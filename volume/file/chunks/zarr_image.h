// SPDX-License-Identifier: Apache-2.0
// Which array of a Zarr folder is the volume, and what its axes are. OME-Zarr: ngff.openmicroscopy.org, up to
// 0.5.
#pragma once

#include <cstddef>
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
  int levels = 1;
  double scale = 1, offset = 0;  ///< a scalar s means scale * s + offset
};

/// Which axis of a volume that is (x: 0), of z, y and x.
constexpr std::size_t volume_axis(ZarrAxis axis) {
  return std::size_t(ZarrAxis::x) - std::size_t(axis);
}

/// Whether a folder is an array or a group of Zarr, of any version.
bool is_zarr(const std::string& folder, const ReadableFiles& files);

/// The array at `level` of a multiscale image, or `folder` itself where it is an array. Throws FileError.
ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files);

}  // namespace understudy::volume
