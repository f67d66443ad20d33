// SPDX-License-Identifier: Apache-2.0
// A volume that is stored image by image, one for each slice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// Images of one size and scalar type.
class SliceImages {
 public:
  virtual ~SliceImages() = default;

  /// The scalars of slice `z`, tightly packed, x fastest, in native byte order. Throws FileError.
  virtual void read(int z, std::span<std::byte> scalars) = 0;
  /// What has been read of all files so far, headers included.
  virtual std::uint64_t bytes_read() const = 0;
  /// The memory that read() takes at most beside `scalars`.
  virtual std::size_t memory_to_read() const = 0;
};

/// Slices are decoded one at a time, and each of them whole. `path` is for messages.
std::unique_ptr<VolumeFile> volume_of_slices(const FileDescription& description,
                                             std::unique_ptr<SliceImages> images, std::string path);

}  // namespace understudy::volume
