// SPDX-License-Identifier: Apache-2.0
// Reads a hierarchical volume (hierarchical_format.h): any box of any level, decoding only the blocks of that
// level and of coarser ones that are needed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volume/file/hierarchical_format.h"
#include "volume/file/volume_file.h"
#include "volume/hierarchy/level_grid.h"

namespace understudy::volume {

class HierarchicalVolume : public VolumeFile {
 public:
  HierarchicalVolume(std::unique_ptr<ByteSource> file, const HierarchicalHeader& header);

  const LevelGrid& grid() const { return grid_; }
  const HierarchicalHeader& header() const { return header_; }
  const HierarchicalBlock& block(std::size_t number) const { return blocks_[number]; }

  /// The largest difference between a scalar of the volume and the interpolation of `level`, from the table.
  double error_of_level(int level) const;

  /// Reads the scalars of `box` in a level, like read(). Throws FileError.
  virtual void read_level(int level, const TexelBox& box, std::span<std::byte> scalars) = 0;
  void read(const TexelBox& box, std::span<std::byte> scalars) final { read_level(0, box, scalars); }
  std::uint64_t bytes_read() const final { return file_->bytes_from_file(); }

 protected:
  ByteSource& file() { return *file_; }

 private:
  std::unique_ptr<ByteSource> file_;
  HierarchicalHeader header_;
  LevelGrid grid_;
  std::vector<HierarchicalBlock> blocks_;
};

/// Reads the header and the table of blocks. Throws FileError.
std::unique_ptr<HierarchicalVolume> open_hierarchical(const std::string& path, const ReadableFiles& files = {});

/// Opens one level as a volume of its own. Throws FileError, also if there is no such level.
std::unique_ptr<VolumeFile> open_level(const std::string& path, int level, const ReadableFiles& files = {});

}  // namespace understudy::volume
