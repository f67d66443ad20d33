// SPDX-License-Identifier: Apache-2.0
// Random access to bytes, independent of where they come from: a file, or compressed contents of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "volume/file/readable_files.h"

namespace understudy::volume {

/// All functions throw FileError.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// Fills `to` with the bytes from `offset` on and returns their number: fewer only at the end.
  virtual std::size_t read(std::uint64_t offset, std::span<std::byte> to) = 0;
  /// Skips up to `most` of the bytes that a read at `offset` must skip first; returns true when none are left.
  virtual bool approach(std::uint64_t /*offset*/, std::uint64_t /*most*/) { return true; }
  /// The number of bytes, if it is known without reading them.
  virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
  /// Number of bytes read from the file itself.
  virtual std::uint64_t bytes_from_file() const = 0;
  /// The file's path, for messages.
  virtual const std::string& path() const = 0;
};

/// A plain file. No byte is read that was not requested.
std::unique_ptr<ByteSource> open_file(const std::string& path, const ReadableFiles& files = {});

/// The same; null if there is no such file.
std::unique_ptr<ByteSource> open_file_if_there(const std::string& path, const ReadableFiles& files = {});

/// Like open_file, but decompresses files whose name ends with .gz.
std::unique_ptr<ByteSource> open_file_or_gzip(const std::string& path, const ReadableFiles& files = {});

/// Whether `path` ends with `extension` (lower case), ignoring the case of `path`.
bool has_extension(const std::string& path, std::string_view extension);

/// A source that is read forwards only: going back restarts it.
class ForwardSource : public ByteSource {
 public:
  explicit ForwardSource(std::shared_ptr<ByteSource> below) : below_(std::move(below)) {}

  std::size_t read(std::uint64_t offset, std::span<std::byte> to) final;
  bool approach(std::uint64_t offset, std::uint64_t most) final;
  std::uint64_t bytes_from_file() const override { return below_->bytes_from_file(); }
  const std::string& path() const override { return below_->path(); }

 protected:
  virtual void restart() = 0;
  /// Reads the next bytes, as many as fit: fewer only at the end.
  virtual std::size_t next(std::span<std::byte> to) = 0;
  ByteSource& below() { return *below_; }

 private:
  /// Skips to `offset`, at most `most` bytes. Returns false if the bytes end before.
  bool pass(std::uint64_t offset, std::uint64_t most);

  std::shared_ptr<ByteSource> below_;
  std::uint64_t position_ = 0;
};

}  // namespace understudy::volume
