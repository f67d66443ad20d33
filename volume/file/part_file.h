// SPDX-License-Identifier: Apache-2.0
// A file that has its name only once it is whole: until then it has none, or, where the file system must have
// one, lies beside it under a name of its own, and is removed if it never becomes whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>

namespace understudy::volume {

/// All functions throw FileError.
class PartFile {
 public:
  explicit PartFile(const std::string& path);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  /// Behind what was written before.
  void append(std::span<const std::byte> bytes);
  /// In the place of what was written there.
  void replace(std::uint64_t at, std::span<const std::byte> bytes);
  std::uint64_t size() const { return size_; }
  /// Gives the file its name. Nothing may be written afterwards.
  void finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void open_without_name();
  void write(std::span<const std::byte> bytes);
  [[noreturn]] void fail() const;

  std::string path_;
  std::string beside_;     ///< the name that it has until it is whole
  bool has_name_ = false;  ///< `beside_`
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

}  // namespace understudy::volume
