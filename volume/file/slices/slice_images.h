// SPDX-License-Identifier: Apache-2.0
// A volume that is stored as one image per slice.
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

  /// Reads the scalars of slice `z`, tightly packed, x fastest, in native byte order. Throws FileError.
  virtual void read(int z, std::span<std::byte> scalars) = 0;
  /// Bytes read from all files so far, including headers.
  virtual std::uint64_t bytes_read() const = 0;
  /// The most memory that read() takes in addition to `scalars`.
  virtual std::size_t memory_to_read() const = 0;
};

/// Slices are decoded one at a time, each as a whole. `path` is for messages.
std::unique_ptr<VolumeFile> volume_of_slices(const FileDescription& description,
                                             std::unique_ptr<SliceImages> images, std::string path);

}  // namespace understudy::volume
