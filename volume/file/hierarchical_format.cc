// SPDX-License-Identifier: Apache-2.0
#include "volume/file/hierarchical_format.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>
#include <optional>

#include "volume/file/file_error.h"
#include "volume/hierarchy/byte_planes.h"

namespace understudy::volume {
namespace {

// The second half detects conversions of line ends by copying as text, like PNG's signature.
constexpr std::array<unsigned char, 8> first_bytes{'U', 'V', 'O', 'L', '\r', '\n', 0x1a, '\n'};
constexpr std::uint32_t format_version = 1;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw FileError(
      fmt::format("{}: not a readable hierarchical volume: {}; convert the volume again", path, what));
}

class NumberWriter {
 public:
  template <std::unsigned_integral T>
  void put(T number) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(std::byte(number >> (8 * i) & 0xff));
  }
  void put(double number) { put(std::bit_cast<std::uint64_t>(number)); }
  std::vector<std::byte>& bytes() { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

class NumberReader {
 public:
  explicit NumberReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <std::unsigned_integral T>
  T get() {
    T number = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      number |= T(T(std::to_integer<unsigned char>(bytes_[i])) << (8 * i));
    bytes_ = bytes_.subspan(sizeof(T));
    return number;
  }
  double real() { return std::bit_cast<double>(get<std::uint64_t>()); }

 private:
  std::span<const std::byte> bytes_;
};

std::uint32_t checksum(std::span<const std::byte> bytes) {
  return std::uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <typename Bytes>
void read_all(ByteSource& file, std::uint64_t at, Bytes& bytes) {
  if (file.read(at, bytes) < bytes.size()) refuse(file.path(), "truncated: it ends before its blocks");
}

}  // namespace

std::array<std::byte, hierarchical_header_bytes> header_bytes(const HierarchicalHeader& header) {
  NumberWriter out;
  for (const unsigned char byte : first_bytes) out.put(std::uint8_t(byte));
  out.put(format_version);
  out.put(std::uint32_t(hierarchy_block_edge));
  for (const int n : header.description.size) out.put(std::uint32_t(n));
  out.put(std::uint32_t(header.description.type));
  out.put(std::uint32_t(header.prediction));
  out.put(std::uint32_t(0));
  for (const double spacing : header.description.spacing) out.put(spacing);
  out.put(header.description.scale);
  out.put(header.description.offset);
  out.put(header.max_error);
  out.bytes().resize(hierarchical_header_bytes - sizeof(std::uint32_t));
  out.put(checksum(out.bytes()));
  std::array<std::byte, hierarchical_header_bytes> bytes{};
  std::ranges::copy(out.bytes(), bytes.begin());
  return bytes;
}

std::vector<std::byte> table_bytes(std::span<const HierarchicalBlock> blocks) {
  NumberWriter out;
  for (const HierarchicalBlock& block : blocks) {
    out.put(block.offset);
    out.put(block.bytes);
    out.put(std::uint32_t(0));
    for (const double number : {block.quantum, block.low, block.high, block.coarser_error}) out.put(number);
  }
  out.put(checksum(out.bytes()));
  return std::move(out.bytes());
}

std::uint64_t blocks_begin(const LevelGrid& grid) {
  return hierarchical_header_bytes + std::uint64_t(grid.count()) * hierarchical_block_bytes +
         sizeof(std::uint32_t);
}

bool is_hierarchical(const std::string& path, const ReadableFiles& files) {
  // A file with this signature and damage elsewhere is refused as damaged.
  constexpr std::size_t name = 4;
  std::array<std::byte, name> bytes{};
  const auto file = open_file(path, files);
  return file->read(0, bytes) == bytes.size() && std::memcmp(bytes.data(), first_bytes.data(), name) == 0;
}

HierarchicalHeader read_hierarchical_header(ByteSource& file) {
  std::array<std::byte, hierarchical_header_bytes> bytes{};
  read_all(file, 0, bytes);
  NumberReader in(bytes);
  for (const unsigned char byte : first_bytes)
    if (in.get<std::uint8_t>() != byte)
      refuse(file.path(), "its first bytes were changed, as copies of text are");
  if (const auto found = in.get<std::uint32_t>(); found != format_version)
    throw FileError(
        fmt::format("{}: a hierarchical volume of version {}, this program reads version {}; convert the "
                    "volume again, or use a newer program",
                    file.path(), found, format_version));
  const auto edge = in.get<std::uint32_t>();
  HierarchicalHeader header;
  std::array<std::int64_t, 3> size{};
  for (std::int64_t& n : size) n = in.get<std::uint32_t>();
  const auto type = in.get<std::uint32_t>();
  const auto prediction = in.get<std::uint32_t>();
  in.get<std::uint32_t>();
  for (double& spacing : header.description.spacing) spacing = in.real();
  header.description.scale = in.real();
  header.description.offset = in.real();
  header.max_error = in.real();
  if (checksum(std::span(bytes).first(bytes.size() - sizeof(std::uint32_t))) !=
      NumberReader(std::span(bytes).last(sizeof(std::uint32_t))).get<std::uint32_t>())
    refuse(file.path(), "its header is damaged");
  if (edge != std::uint32_t(hierarchy_block_edge))
    refuse(file.path(), fmt::format("blocks of {} samples an edge, not {}", edge, hierarchy_block_edge));
  if (type > std::uint32_t(ScalarType::f64)) refuse(file.path(), fmt::format("scalars of type {}", type));
  if (prediction > std::uint32_t(Prediction::cubic))
    refuse(file.path(), fmt::format("prediction {}", prediction));
  header.description.type = ScalarType(type);
  header.prediction = Prediction(prediction);
  checked_bytes(size, header.description.type, file.path());
  for (std::size_t k = 0; k < 3; ++k) {
    header.description.size[k] = int(size[k]);
    header.description.spacing[k] = believable_spacing(header.description.spacing[k]);
  }
  const double scale = header.description.scale;
  if (!std::isfinite(scale) || scale == 0 || !std::isfinite(header.description.offset))
    refuse(file.path(),
           fmt::format("its scalars are scaled by {} from {} on", scale, header.description.offset));
  if (!(header.max_error >= 0) || !std::isfinite(header.max_error))
    refuse(file.path(), fmt::format("an error of {} is said to have been allowed", header.max_error));
  return header;
}

std::vector<HierarchicalBlock> read_block_table(ByteSource& file, const HierarchicalHeader& header,
                                                const LevelGrid& grid) {
  const std::optional<std::uint64_t> there = file.size();
  const std::uint64_t first = blocks_begin(grid);
  // Checked before memory is allocated according to the header.
  if (!there || *there < first) refuse(file.path(), "truncated: it ends before its blocks");
  std::vector<std::byte> bytes(std::size_t(first) - hierarchical_header_bytes);
  read_all(file, hierarchical_header_bytes, bytes);
  const auto numbers = std::span(bytes).first(bytes.size() - sizeof(std::uint32_t));
  if (checksum(numbers) != NumberReader(std::span(bytes).last(sizeof(std::uint32_t))).get<std::uint32_t>())
    refuse(file.path(), "its table of blocks is damaged");
  NumberReader in(numbers);
  std::vector<HierarchicalBlock> blocks(grid.count());
  const std::size_t most = most_packed_bytes(std::size_t(hierarchy_block_edge) * hierarchy_block_edge *
                                             hierarchy_block_edge * bytes_per_scalar(header.description.type));
  for (HierarchicalBlock& block : blocks) {
    block.offset = in.get<std::uint64_t>();
    block.bytes = in.get<std::uint32_t>();
    in.get<std::uint32_t>();
    for (double* number : {&block.quantum, &block.low, &block.high, &block.coarser_error}) *number = in.real();
    if (block.offset < first || block.offset > *there || block.bytes > *there - block.offset ||
        block.bytes > most)
      refuse(file.path(), fmt::format("a block of {} bytes at {} of {}", block.bytes, block.offset, *there));
    const bool sound = block.quantum >= 0 && std::isfinite(block.quantum) && block.coarser_error >= 0 &&
                       !std::isnan(block.low) && !std::isnan(block.high);
    if (!sound)
      refuse(file.path(), fmt::format("a block of values {} to {}, in multiples of {}, off by {}", block.low,
                                      block.high, block.quantum, block.coarser_error));
  }
  return blocks;
}

}  // namespace understudy::volume
