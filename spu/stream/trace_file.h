// SPDX-License-Identifier: Apache-2.0
// Streams kept in files.
//
//     file header    32 bytes: "UNDERSTUDY-TRACE", version, 12 bytes zero
//     block header   64 bytes: BlockHeader
//     block          one zstd frame: the records' words, then the payload's words
//     ...
//
// A block is whole frames where frames are small enough. A file that was cut off is readable up to its last
// whole block. All numbers are little-endian; every version that was ever written stays readable.
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
  std::uint32_t frames = 0;  ///< that end within the block
  std::uint64_t number = 0;  ///< from 0, so that a missing block is noticed
  std::uint64_t record_words = 0;
  std::uint64_t payload_words = 0;
  std::uint64_t compressed_bytes = 0;
  std::uint64_t checksum = 0;  ///< FNV-1a of the fields above
  std::uint64_t reserved[2] = {};
};
static_assert(sizeof(BlockHeader) == 64);
/// What belongs into `checksum`.
std::uint64_t header_checksum(const BlockHeader& header);

/// What a block may claim to unpack to; a reader takes no more memory than really comes out.
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
  /// Creates the file; one that exists is replaced. Throws std::system_error.
  explicit TraceWriter(const std::filesystem::path& path);
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  /// Appends the records as one block. Throws std::system_error when the disk is full; the file then ends with
  /// its last whole block.
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
  /// Throws std::runtime_error when the file cannot be read or is no trace of a version known here.
  explicit TraceReader(const std::filesystem::path& path);
  /// A trace in memory, which must outlive the reader.
  explicit TraceReader(std::span<const std::byte> file);
  ~TraceReader();

  /// The next block; nothing at the end. Throws std::runtime_error naming block and offset when it is damaged.
  std::optional<Block> next();
  /// The file ends within a block: everything before was read.
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
