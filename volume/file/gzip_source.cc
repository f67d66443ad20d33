// SPDX-License-Identifier: Apache-2.0
#include "volume/file/gzip_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

constexpr int gzip_or_zlib = 15 + 32;  // the largest window; detects the format

}  // namespace

GzipSource::GzipSource(std::shared_ptr<ByteSource> below, std::uint64_t offset)
    : ForwardSource(std::move(below)), start_(offset) {
  if (inflateInit2(&stream_, gzip_or_zlib) != Z_OK) throw std::bad_alloc();
}

GzipSource::~GzipSource() {
  inflateEnd(&stream_);
}

void GzipSource::restart() {
  inflateReset2(&stream_, gzip_or_zlib);
  stream_.avail_in = 0;
  from_ = start_;
  ended_ = false;
}

bool GzipSource::refill() {
  const std::size_t got = below().read(from_, compressed_);
  from_ += got;
  stream_.next_in = reinterpret_cast<Bytef*>(compressed_.data());
  stream_.avail_in = static_cast<uInt>(got);
  return got > 0;
}

void GzipSource::fail(const char* what) const {
  throw FileError(fmt::format("{}: its compressed data is damaged ({}); get the file again", path(),
                              what ? what : "unknown"));
}

std::size_t GzipSource::next(std::span<std::byte> to) {
  std::size_t filled = 0;
  while (filled < to.size() && !ended_) {
    if (stream_.avail_in == 0 && !refill()) break;
    const std::size_t room = std::min<std::size_t>(to.size() - filled, std::numeric_limits<uInt>::max());
    stream_.next_out = reinterpret_cast<Bytef*>(to.data() + filled);
    stream_.avail_out = static_cast<uInt>(room);
    const int code = inflate(&stream_, Z_NO_FLUSH);
    filled += room - stream_.avail_out;
    if (code == Z_STREAM_END) {
      // Another gzip member may follow; any other data after the stream is ignored.
      if (stream_.avail_in == 0) refill();
      ended_ = stream_.avail_in == 0 || *stream_.next_in != 0x1f;
      if (!ended_) inflateReset(&stream_);
    } else if (code != Z_OK && code != Z_BUF_ERROR) {
      fail(stream_.msg);
    }
  }
  return filled;
}

}  // namespace understudy::volume
