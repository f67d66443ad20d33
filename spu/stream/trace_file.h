// SPDX-License-Identifier: Apache-2.0
// Streams stored in files.
//
//     file header    32 bytes: "UNDERSTUDY-TRACE", version, 12 bytes zero
//     block header   64 bytes: BlockHeader
//     block          one zstd frame: the records' words, then the payload's words
//     ...
//
// If frames are small, a block consists of whole frames. A truncated file is readable up to its last complete
// block. All numbers are little-endian; every version that was ever written stays readable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/stream/record.h"

namespace understudy::spu {

constexpr std::uint32_t trace_version = 1;
constexpr char trace_magic[16] = {'U', 'N', 'D', 'E', 'R', 'S', 'T', 'U',
                                  'D', 'Y', '-', 'T', 'R', 'A', 'C', 'E'};

struct BlockHeader {
  static constexpr std::uint32_t right_magic = stable_id_of("understudy.block");

  std::uint32_t magic = right_magic;
  std::uint32_t frames = 0;  ///< that end in the block
  std::uint64_t number = 0;  ///< from 0, to detect missing blocks
  std::uint64_t record_words = 0;
  std::uint64_t payload_words = 0;
  std::uint64_t compressed_bytes = 0;
  std::uint64_t checksum = 0;  ///< FNV-1a of the fields above
  std::uint64_t reserved[2] = {};
};
static_assert(sizeof(BlockHeader) == 64);
/// The value of `checksum`.
std::uint64_t header_checksum(const BlockHeader& header);

/// Limit for the unpacked size in a header; a reader allocates only as much as is really unpacked.
constexpr std::uint64_t most_block_words = std::uint64_t(1) << 29;

struct Block {
  std::uint64_t number = 0;
  std::uint64_t file_offset = 0;
  std::uint32_t frames = 0;
  std::vector<std::uint64_t> records;
  std::vector<std::uint64_t> payload;
};

/// "trace.ust: block 3 at byte 4711: what"
std::string in_block(const Block& block, std::string_view what);

class TraceWriter {
 public:
  /// Creates or replaces the file. Throws std::system_error.
  explicit TraceWriter(const std::filesystem::path& path);
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  /// Appends the records as one block. Throws std::system_error if the disk is full; the file then ends with
  /// its last complete block.
  void write(const Records& records, std::uint32_t frames);

  std::uint64_t bytes() const { return bytes_; }

 private:
  int file_ = -1;
  std::string name_;
  std::uint64_t blocks_ = 0;
  std::uint64_t bytes_ = 0;
  std::vector<std::byte> compressed_;
};

class TraceReader {
 public:
  /// Throws std::runtime_error if the file cannot be read or is not a trace of a known version.
  explicit TraceReader(const std::filesystem::path& path);
  /// Reads a trace in memory, which must outlive the reader.
  explicit TraceReader(std::span<const std::byte> file);
  ~TraceReader();

  /// Returns the next block; nothing at the end. Throws std::runtime_error with number and offset if damaged.
  std::optional<Block> next();
  /// Whether the file ends within a block; everything before it was read.
  bool cut_off() const { return cut_off_; }

 private:
  std::size_t read(std::span<std::byte> into);
  void read_header();

  std::ifstream file_;
  std::span<const std::byte> memory_;
  std::string name_;
  std::uint64_t offset_ = 0;
  std::uint64_t blocks_ = 0;
  bool cut_off_ = false;
};

}  // namespace understudy::spu
