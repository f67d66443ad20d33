// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/bytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

// Memory grows with the bytes that are actually read, so a small file that claims to be huge costs nothing.
constexpr std::int64_t step_bytes = std::int64_t{64} << 20;

/// Reads from the file's current position; returns the number of bytes, fewer than requested only at the end of
/// the file. Throws if the file is damaged.
using Read = std::function<std::int64_t(std::byte* destination, std::int64_t count)>;

[[noreturn]] void throw_unreadable(const std::string& path, const std::string& reason) {
  throw Error(ExitCode::bad_file,
              fmt::format("{}: cannot be read: {}; check its permissions or get the file again", path, reason));
}

Read plain_reader(const std::string& path, std::int64_t offset) {
  const std::shared_ptr<std::FILE> file(std::fopen(path.c_str(), "rb"), [](std::FILE* f) {
    if (f) std::fclose(f);
  });
  if (!file || fseeko(file.get(), offset, SEEK_SET) != 0) throw_unreadable(path, std::strerror(errno));
  return [file, path](std::byte* destination, std::int64_t count) {
    const std::size_t got = std::fread(destination, 1, static_cast<std::size_t>(count), file.get());
    if (std::ferror(file.get())) throw_unreadable(path, std::strerror(errno));
    return static_cast<std::int64_t>(got);
  };
}

Read gzip_reader(const std::string& path, std::int64_t offset) {
  const std::shared_ptr<gzFile_s> file(gzopen64(path.c_str(), "rb"), [](gzFile f) {
    if (f) gzclose(f);
  });
  if (!file) throw_unreadable(path, std::strerror(errno));
  if (offset > 0 && gzseek64(file.get(), offset, SEEK_SET) != offset)
    throw_unreadable(path, "the position does not exist");
  return [file, path](std::byte* destination, std::int64_t count) {
    const int got = gzread(file.get(), destination, static_cast<unsigned>(count));
    int code = Z_OK;
    const char* reason = gzerror(file.get(), &code);
    // Z_BUF_ERROR is a stream that ends too early: the caller reports it as truncated, with the bytes found.
    if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
      throw_unreadable(path, code == Z_ERRNO ? std::strerror(errno) : reason);
    return std::int64_t{std::max(got, 0)};
  };
}

[[noreturn]] void throw_short(const std::string& path, std::int64_t expected, std::int64_t found,
                              const std::string& advice) {
  throw Error(ExitCode::bad_file,
              fmt::format("{}: truncated: expected {} bytes, found {}; {}", path, expected, found, advice));
}

[[noreturn]] void throw_long(const std::string& path, std::int64_t expected, const std::string& found,
                             const std::string& advice) {
  throw Error(ExitCode::bad_file,
              fmt::format("{}: the file and the volume's size disagree: expected {} bytes, found {}; {}", path,
                          expected, found, advice));
}

}  // namespace

bool has_extension(const std::string& path, std::string_view extension) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return path.size() >= extension.size() &&
         std::equal(extension.begin(), extension.end(),
                    path.end() - static_cast<std::ptrdiff_t>(extension.size()),
                    [&](char wanted, char present) { return same(present, wanted); });
}

std::vector<std::byte> read_bytes(const std::string& path, std::int64_t offset, std::int64_t count,
                                  Remainder remainder, const std::string& advice) {
  const bool compressed = has_extension(path, ".gz");
  const std::int64_t expected = offset + count;
  if (!compressed) {
    // The size is known without reading: report errors before gigabytes are read.
    std::error_code no_size;
    const auto size = std::filesystem::file_size(path, no_size);
    if (!no_size) {
      const auto found = static_cast<std::int64_t>(size);
      if (found < expected) throw_short(path, expected, found, advice);
      if (found > expected && remainder == Remainder::forbidden)
        throw_long(path, expected, std::to_string(found), advice);
    }
  }

  const Read read = compressed ? gzip_reader(path, offset) : plain_reader(path, offset);
  std::vector<std::byte> bytes;
  while (static_cast<std::int64_t>(bytes.size()) < count) {
    const auto filled = static_cast<std::int64_t>(bytes.size());
    const std::int64_t wanted = std::min(count - filled, step_bytes);
    bytes.resize(static_cast<std::size_t>(filled + wanted));
    const std::int64_t got = read(bytes.data() + filled, wanted);
    if (got < wanted) throw_short(path, expected, offset + filled + got, advice);
  }
  std::byte one_more{};
  if (remainder == Remainder::forbidden && read(&one_more, 1) > 0) throw_long(path, expected, "more", advice);
  return bytes;
}

void swap_byte_order(std::span<std::byte> bytes, std::size_t element_bytes) {
  if (element_bytes < 2) return;
  for (std::size_t at = 0; at + element_bytes <= bytes.size(); at += element_bytes)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + element_bytes));
}

}  // namespace viewer
