// SPDX-License-Identifier: Apache-2.0
#include "volume/file/byte_source.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/gzip_source.h"

namespace understudy::volume {

namespace {

/// Owns a file descriptor, so that it is closed even if a constructor throws.
struct Descriptor {
  int number = -1;

  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

class PlainFile : public ByteSource {
 public:
  PlainFile(std::string path, int opened) : path_(std::move(path)), file_(opened) {
    struct stat about {};
    if (::fstat(file_.number, &about) != 0) fail();
    if (S_ISDIR(about.st_mode))
      throw FileError(fmt::format("{}: is a folder; name the volume file in it", path_));
    if (!S_ISREG(about.st_mode))
      throw FileError(fmt::format("{}: is no regular file; write its contents into one first", path_));
    size_ = std::uint64_t(about.st_size);
  }

  std::size_t read(std::uint64_t offset, std::span<std::byte> to) override {
    std::size_t filled = 0;
    while (filled < to.size() && offset + filled < size_) {
      const ssize_t got =
          ::pread(file_.number, to.data() + filled, to.size() - filled, static_cast<off_t>(offset + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail();
      if (got == 0) break;
      filled += std::size_t(got);
    }
    read_ += filled;
    return filled;
  }
  std::optional<std::uint64_t> size() const override { return size_; }
  std::uint64_t bytes_from_file() const override { return read_; }
  const std::string& path() const override { return path_; }

 private:
  [[noreturn]] void fail() const {
    throw FileError(
        fmt::format("{}: cannot be read: {}; check the path and its permissions", path_, std::strerror(errno)));
  }

  std::string path_;
  Descriptor file_;
  std::uint64_t size_ = 0;
  std::uint64_t read_ = 0;
};

}  // namespace

std::unique_ptr<ByteSource> open_file(const std::string& path, const ReadableFiles& files) {
  return std::make_unique<PlainFile>(path, files.open(path));
}

std::unique_ptr<ByteSource> open_file_if_there(const std::string& path, const ReadableFiles& files) {
  const int file = files.open_if_there(path);
  return file < 0 ? nullptr : std::make_unique<PlainFile>(path, file);
}

std::unique_ptr<ByteSource> open_file_or_gzip(const std::string& path, const ReadableFiles& files) {
  std::unique_ptr<ByteSource> file = open_file(path, files);
  if (!has_extension(path, ".gz")) return file;
  return std::make_unique<GzipSource>(std::move(file), 0);
}

bool has_extension(const std::string& path, std::string_view extension) {
  const auto same = [](char wanted, char present) {
    return std::tolower(static_cast<unsigned char>(present)) == wanted;
  };
  return path.size() >= extension.size() &&
         std::equal(extension.begin(), extension.end(), path.end() - std::ptrdiff_t(extension.size()), same);
}

bool ForwardSource::pass(std::uint64_t offset, std::uint64_t most) {
  if (offset < position_ || position_ == 0) {
    restart();
    position_ = 0;
  }
  std::vector<std::byte> passed(std::size_t(std::min<std::uint64_t>(offset - position_, 1U << 16)));
  const std::uint64_t end = position_ + std::min(most, offset - position_);
  while (position_ < end) {
    const std::size_t wanted = std::size_t(std::min<std::uint64_t>(end - position_, passed.size()));
    const std::size_t got = next(std::span(passed).first(wanted));
    position_ += got;
    if (got < wanted) return false;
  }
  return true;
}

bool ForwardSource::approach(std::uint64_t offset, std::uint64_t most) {
  return !pass(offset, most) || position_ >= offset;
}

std::size_t ForwardSource::read(std::uint64_t offset, std::span<std::byte> to) {
  if (!pass(offset, std::numeric_limits<std::uint64_t>::max())) return 0;
  const std::size_t got = next(to);
  position_ += got;
  return got;
}

}  // namespace understudy::volume
