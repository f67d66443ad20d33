// SPDX-License-Identifier: Apache-2.0
// The file format of hierarchical volumes (.uvol), version 1: docs/format.md. A header, a table of blocks from
// the coarsest level on, and the blocks in the same order. Numbers are little-endian.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "volume/file/byte_source.h"
#include "volume/file/volume_file.h"
#include "volume/hierarchy/interpolation.h"
#include "volume/hierarchy/level_grid.h"

namespace understudy::volume {

struct HierarchicalHeader {
  FileDescription description;
  Prediction prediction = Prediction::linear;
  double max_error = 0;  ///< permitted, in scalars of the file
};

/// A block's entry in the table.
struct HierarchicalBlock {
  std::uint64_t offset = 0;  ///< in the file
  std::uint32_t bytes = 0;
  double quantum = 0;  ///< of its residuals (BlockCoding)
  /// The least and the greatest scalar of the volume in the block's region, ignoring NaN; low > high: there is
  /// none.
  double low = 0;
  double high = -1;
  /// Upper bound of the difference between the volume's scalars in the region and the trilinear interpolation
  /// of the next coarser level. Infinite if some scalars are not finite. For the coarsest level: 0.
  double coarser_error = 0;
};

constexpr std::size_t hierarchical_header_bytes = 128;
constexpr std::size_t hierarchical_block_bytes = 48;

std::array<std::byte, hierarchical_header_bytes> header_bytes(const HierarchicalHeader& header);
/// Includes the checksum.
std::vector<std::byte> table_bytes(std::span<const HierarchicalBlock> blocks);

/// The lowest possible offset of the first block.
std::uint64_t blocks_begin(const LevelGrid& grid);

/// By the first bytes.
bool is_hierarchical(const std::string& path, const ReadableFiles& files = {});

/// Both throw FileError, naming the file.
HierarchicalHeader read_hierarchical_header(ByteSource& file);
/// Every block is checked to lie in the file and to have no more bytes than its samples can take.
std::vector<HierarchicalBlock> read_block_table(ByteSource& file, const HierarchicalHeader& header,
                                                const LevelGrid& grid);

}  // namespace understudy::volume
