// SPDX-License-Identifier: Apache-2.0
// What the JSON files of a Zarr folder say: zarr.readthedocs.io/en/stable/spec/v2.html,
// ngff.openmicroscopy.org/0.4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volume/file/chunks/chunk_codec.h"
#include "volume/file/readable_files.h"
#include "volume/file/scalar_type.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// An array of scalars with some axes, the slowest first as the format lists them.
struct ZarrArray {
  std::vector<std::int64_t> shape;
  std::vector<std::int64_t> chunks;  ///< length of a chunk along each axis
  ScalarType type = ScalarType::u8;
  bool big_endian = false;
  bool first_axis_fastest = false;  ///< order "F", within a chunk
  char separator = '.';             ///< between the numbers in a chunk's name
  ChunkCodec codec;
  double fill = 0;  ///< of chunks that are not there
};

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

/// Throws FileError.
ZarrArray zarr_array(const std::string& folder, const ReadableFiles& files);

}  // namespace understudy::volume
