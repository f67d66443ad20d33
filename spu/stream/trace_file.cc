// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/trace_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace understudy::spu {
namespace {

/// A fast level of zstd: writing a trace must not slow down the viewer more than its calls do.
constexpr int compression_level = 3;

constexpr std::size_t file_header_bytes = 32;

struct StreamDeleter {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
  void operator()(ZSTD_CStream* stream) const { ZSTD_freeCStream(stream); }
};

/// Decompresses into exactly `words` words; memory grows with the output, not with the size in the header.
std::vector<std::uint64_t> unpacked(std::span<const std::byte> compressed, std::uint64_t words) {
  const std::unique_ptr<ZSTD_DStream, StreamDeleter> stream(ZSTD_createDStream());
  std::vector<std::uint64_t> result;
  ZSTD_inBuffer input{compressed.data(), compressed.size(), 0};
  std::uint64_t bytes = 0;
  std::size_t left = 1;
  while (left != 0) {
    if (bytes == result.size() * 8) {
      if (result.size() == words + 1) throw std::runtime_error("holds more than it says");
      result.resize(std::min<std::uint64_t>(words + 1, std::max<std::uint64_t>(result.size() * 2, 1 << 16)));
    }
    ZSTD_outBuffer output{reinterpret_cast<std::byte*>(result.data()) + bytes, result.size() * 8 - bytes, 0};
    left = ZSTD_decompressStream(stream.get(), &output, &input);
    if (ZSTD_isError(left) != 0) throw std::runtime_error(ZSTD_getErrorName(left));
    bytes += output.pos;
    if (left != 0 && output.pos == 0 && input.pos == input.size && bytes < result.size() * 8)
      throw std::runtime_error("its data end early");
  }
  if (bytes != words * 8) throw std::runtime_error("does not hold as much as it says");
  result.resize(words);
  return result;
}

}  // namespace

std::uint64_t header_checksum(const BlockHeader& header) {
  std::array<std::uint8_t, offsetof(BlockHeader, checksum)> bytes{};
  std::memcpy(bytes.data(), &header, bytes.size());
  std::uint64_t sum = 0xcbf2'9ce4'8422'2325U;
  for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 0x0000'0100'0000'01b3U;
  return sum;
}

std::string in_block(const Block& block, std::string_view what) {
  return fmt::format("block {} at byte {}: {}", block.number, block.file_offset, what);
}

TraceWriter::TraceWriter(const std::filesystem::path& path)
    : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)), name_(path.string()) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), name_ + " cannot be written");
  std::array<std::byte, file_header_bytes> header{};
  std::memcpy(header.data(), trace_magic, sizeof trace_magic);
  std::memcpy(header.data() + sizeof trace_magic, &trace_version, sizeof trace_version);
  if (::write(file_, header.data(), header.size()) != ssize_t(header.size()))
    throw std::system_error(errno, std::generic_category(), name_ + " cannot be written");
  bytes_ = header.size();
}

TraceWriter::~TraceWriter() {
  if (file_ >= 0) ::close(file_);
}

void TraceWriter::write(const Records& records, std::uint32_t frames) {
  const auto words = std::as_bytes(records.words());
  const auto payload = std::as_bytes(records.payload());
  compressed_.resize(sizeof(BlockHeader) + ZSTD_compressBound(words.size() + payload.size()));
  const std::unique_ptr<ZSTD_CStream, StreamDeleter> stream(ZSTD_createCStream());
  ZSTD_CCtx_setParameter(stream.get(), ZSTD_c_compressionLevel, compression_level);
  ZSTD_CCtx_setParameter(stream.get(), ZSTD_c_checksumFlag, 1);
  ZSTD_outBuffer output{compressed_.data() + sizeof(BlockHeader), compressed_.size() - sizeof(BlockHeader), 0};
  for (const auto& part : {words, payload}) {
    ZSTD_inBuffer input{part.data(), part.size(), 0};
    const bool last = part.data() == payload.data() && part.size() == payload.size();
    if (!last) ZSTD_compressStream2(stream.get(), &output, &input, ZSTD_e_continue);
    if (last) ZSTD_compressStream2(stream.get(), &output, &input, ZSTD_e_end);
  }
  BlockHeader header;
  header.frames = frames;
  header.number = blocks_;
  header.record_words = records.words().size();
  header.payload_words = records.payload().size();
  header.compressed_bytes = output.pos;
  header.checksum = header_checksum(header);
  std::memcpy(compressed_.data(), &header, sizeof header);
  const std::size_t size = sizeof header + output.pos;
  for (std::size_t written = 0; written < size;) {
    const ssize_t step = ::write(file_, compressed_.data() + written, size - written);
    if (step < 0 && errno == EINTR) continue;
    if (step <= 0) {
      const int error = errno;
      // The incomplete block is removed, so that the file ends with a complete one.
      if (::ftruncate(file_, off_t(bytes_)) == 0) ::lseek(file_, off_t(bytes_), SEEK_SET);
      throw std::system_error(error, std::generic_category(), name_ + " cannot be written further");
    }
    written += std::size_t(step);
  }
  bytes_ += size;
  ++blocks_;
}

TraceReader::TraceReader(const std::filesystem::path& path)
    : file_(path, std::ios::binary), name_(path.string()) {
  if (!file_) throw std::runtime_error(name_ + " cannot be read; is the path right?");
  read_header();
}

TraceReader::TraceReader(std::span<const std::byte> file) : memory_(file), name_("trace") {
  read_header();
}

TraceReader::~TraceReader() = default;

std::size_t TraceReader::read(std::span<std::byte> into) {
  std::size_t got = 0;
  if (file_.is_open()) {
    file_.read(reinterpret_cast<char*>(into.data()), std::streamsize(into.size()));
    got = std::size_t(file_.gcount());
  } else {
    got = std::min<std::size_t>(into.size(), memory_.size() - offset_);
    if (got != 0) std::memcpy(into.data(), memory_.data() + offset_, got);
  }
  offset_ += got;
  return got;
}

void TraceReader::read_header() {
  std::array<std::byte, file_header_bytes> header{};
  std::uint32_t version = 0;
  const std::size_t got = read(header);
  std::memcpy(&version, header.data() + sizeof trace_magic, sizeof version);
  if (got < header.size() || std::memcmp(header.data(), trace_magic, sizeof trace_magic) != 0)
    throw std::runtime_error(name_ + " is no trace; `understudy run --trace FILE -- viewer` makes one");
  if (version == 0 || version > trace_version) {
    throw std::runtime_error(
        fmt::format("{} is of version {}, and this is made for versions up to {}; a newer "
                    "understudy reads it",
                    name_, version, trace_version));
  }
}

std::optional<Block> TraceReader::next() {
  if (cut_off_) return std::nullopt;
  BlockHeader header;
  Block block;
  block.file_offset = offset_;
  block.number = blocks_;
  const std::size_t got = read(std::as_writable_bytes(std::span(&header, 1)));
  if (got == 0) return std::nullopt;
  const auto damaged = [&](std::string_view what) {
    return std::runtime_error(fmt::format("{}: {}", name_, in_block(block, what)));
  };
  if (got < sizeof header) {
    cut_off_ = true;
    return std::nullopt;
  }
  if (header.magic != BlockHeader::right_magic || header.checksum != header_checksum(header))
    throw damaged("no block begins there");
  if (header.number != blocks_) throw damaged(fmt::format("it is block {}: some are missing", header.number));
  if (header.record_words > most_block_words || header.payload_words > most_block_words ||
      header.compressed_bytes > (header.record_words + header.payload_words) * 9 + 1024) {
    throw damaged("its size is not to be believed");
  }
  std::vector<std::byte> compressed;
  while (compressed.size() < header.compressed_bytes) {
    constexpr std::uint64_t step = 1 << 20;
    const std::size_t before = compressed.size();
    compressed.resize(std::min<std::uint64_t>(header.compressed_bytes, before + step));
    const std::size_t part = read(std::span(compressed).subspan(before));
    if (part < compressed.size() - before) {
      cut_off_ = true;
      return std::nullopt;
    }
  }
  try {
    block.records = unpacked(compressed, header.record_words + header.payload_words);
  } catch (const std::runtime_error& error) {
    throw damaged(error.what());
  }
  block.payload.assign(block.records.begin() + std::ptrdiff_t(header.record_words), block.records.end());
  block.records.resize(header.record_words);
  block.frames = header.frames;
  ++blocks_;
  return block;
}

}  // namespace understudy::spu
