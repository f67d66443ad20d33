// SPDX-License-Identifier: Apache-2.0
// Bytes by their place, wherever they come from: a file, or what a file holds in compressed form.
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

  /// Fills `to` with the bytes from `offset` on and returns how many there were: fewer only at the end.
  virtual std::size_t read(std::uint64_t offset, std::span<std::byte> to) = 0;
  /// Passes over up to `most` of the bytes that a read at `offset` must pass over first; true: none are left.
  virtual bool approach(std::uint64_t /*offset*/, std::uint64_t /*most*/) { return true; }
  /// How many bytes there are, where that is known without reading them.
  virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
  /// What has been read of the file itself.
  virtual std::uint64_t bytes_from_file() const = 0;
  /// The file's, for messages.
  virtual const std::string& path() const = 0;
};

/// A plain file, of which no byte is read that was not asked for.
std::unique_ptr<ByteSource> open_file(const std::string& path, const ReadableFiles& files = {});

/// The same; null where there is no such file.
std::unique_ptr<ByteSource> open_file_if_there(const std::string& path, const ReadableFiles& files = {});

/// The same as open_file, or what is in it when its name ends with .gz.
std::unique_ptr<ByteSource> open_file_or_gzip(const std::string& path, const ReadableFiles& files = {});

/// Whether `path` ends so, capitals aside.
bool has_extension(const std::string& path, std::string_view extension);

/// A source that only goes forward: going back means to begin again.
class ForwardSource : public ByteSource {
 public:
  explicit ForwardSource(std::shared_ptr<ByteSource> below) : below_(std::move(below)) {}

  std::size_t read(std::uint64_t offset, std::span<std::byte> to) final;
  bool approach(std::uint64_t offset, std::uint64_t most) final;
  std::uint64_t bytes_from_file() const override { return below_->bytes_from_file(); }
  const std::string& path() const override { return below_->path(); }

 protected:
  virtual void restart() = 0;
  /// The next bytes, as many as there is room for: fewer only at the end.
  virtual std::size_t next(std::span<std::byte> to) = 0;
  ByteSource& below() { return *below_; }

 private:
  /// False where the bytes end before `offset`.
  bool pass(std::uint64_t offset, std::uint64_t most);

  std::shared_ptr<ByteSource> below_;
  std::uint64_t position_ = 0;
};

}  // namespace understudy::volume
