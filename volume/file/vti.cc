// SPDX-License-Identifier: Apache-2.0
#include "volume/file/vti.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "volume/file/base64_source.h"
#include "volume/file/file_error.h"
#include "volume/file/vti_header.h"
#include "volume/file/zlib_blocks.h"

namespace understudy::volume {

namespace {

constexpr std::uint64_t max_block_bytes = std::uint64_t(1) << 28;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: not a readable VTK image file: {}; get the file again", path, what));
}

/// The numbers in front of the data.
class Lengths {
 public:
  Lengths(ByteSource& source, std::uint64_t at, const VtiHeader& header)
      : source_(source), at_(at), header_(header) {}

  std::vector<std::uint64_t> read(std::size_t first, std::size_t count) {
    std::vector<std::byte> bytes(count * header_.length_bytes);
    if (source_.read(at_ + first * header_.length_bytes, bytes) < bytes.size())
      fail(source_.path(), "truncated: it ends before its data");
    std::vector<std::uint64_t> numbers(count, 0);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::size_t in_number = i % header_.length_bytes;
      const std::size_t place = header_.big_endian ? header_.length_bytes - 1 - in_number : in_number;
      numbers[i / header_.length_bytes] |= std::uint64_t(bytes[i]) << (8 * place);
    }
    return numbers;
  }

 private:
  ByteSource& source_;
  std::uint64_t at_;
  const VtiHeader& header_;
};

ZlibBlockTable read_block_table(Lengths lengths, std::uint64_t bytes, const std::string& path) {
  const std::vector<std::uint64_t> head = lengths.read(0, 3);
  const std::uint64_t blocks = head[0], block_bytes = head[1], last = head[2];
  // Checks an upper bound first, so that the product cannot overflow.
  if (blocks == 0 || block_bytes == 0 || block_bytes > max_block_bytes || last > block_bytes ||
      blocks > bytes / block_bytes + 1 ||
      (blocks - 1) * block_bytes + (last == 0 ? block_bytes : last) != bytes)
    fail(path, fmt::format("{} blocks of {} bytes, the last of {}, are not its {} bytes of scalars", blocks,
                           block_bytes, last, bytes));
  ZlibBlockTable table;
  table.block_bytes = block_bytes;
  table.total_bytes = bytes;
  table.offsets.push_back(0);
  constexpr std::size_t at_once = 4096;
  for (std::size_t first = 0; first < blocks; first += at_once)
    for (const std::uint64_t packed :
         lengths.read(3 + first, std::size_t(std::min<std::uint64_t>(at_once, blocks - first)))) {
      if (packed > compressBound(block_bytes))
        fail(path, fmt::format("a compressed block of {} bytes", packed));
      table.offsets.push_back(table.offsets.back() + packed);
    }
  return table;
}

}  // namespace

bool is_vti(const std::string& path) {
  return has_extension(path, ".vti") || has_extension(path, ".vti.gz");
}

std::unique_ptr<VolumeFile> open_vti(const std::string& path, const ReadableFiles& files) {
  std::shared_ptr<ByteSource> file = open_file_or_gzip(path, files);
  const VtiHeader header = read_vti_header(*file);
  FileDescription description;
  description.type = header.type;
  const std::uint64_t bytes = checked_bytes(header.size, header.type, path);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    description.size[axis] = int(header.size[axis]);
    description.spacing[axis] = believable_spacing(header.spacing[axis]);
  }

  // The positions of the numbers and of the data behind them.
  const bool base64 = header.encoding == VtiHeader::Encoding::base64;
  std::shared_ptr<ByteSource> front = file;
  std::uint64_t front_at = header.data_at;
  if (base64) {
    front = std::make_shared<Base64Source>(file, header.data_at);
    front_at = 0;
  }
  Lengths lengths(*front, front_at, header);
  DenseScalars scalars;
  scalars.big_endian = header.big_endian;
  scalars.advice = "it is shorter than its header says: get the file again";
  if (!header.compressed) {
    if (const std::uint64_t length = lengths.read(0, 1)[0]; length != bytes)
      fail(path, fmt::format("its scalars are said to have {} bytes, not {}", length, bytes));
    // Numbers and data are one base64 text.
    scalars.offset = front_at + header.length_bytes;
    scalars.bytes = base64 ? std::unique_ptr<ByteSource>(std::make_unique<Base64Source>(file, header.data_at))
                           : open_file_or_gzip(path, files);
    return dense_volume(description, std::move(scalars));
  }
  ZlibBlockTable table = read_block_table(lengths, bytes, path);
  const std::uint64_t front_bytes = (2 + table.offsets.size()) * header.length_bytes;
  std::shared_ptr<ByteSource> blocks = file;
  if (base64) {
    // The numbers are a separate base64 text, with its own padding.
    blocks = std::make_shared<Base64Source>(file, header.data_at + (front_bytes + 2) / 3 * 4);
  } else {
    for (std::uint64_t& offset : table.offsets) offset += header.data_at + front_bytes;
  }
  scalars.bytes = std::make_unique<ZlibBlocks>(std::move(blocks), std::move(table));
  return dense_volume(description, std::move(scalars));
}

}  // namespace understudy::volume
