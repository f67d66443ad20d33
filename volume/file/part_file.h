// SPDX-License-Identifier: Apache-2.0
// A file that gets its name only when it is complete. Until then it has no name, or, if the file system
// requires one, a temporary name in the same folder; it is removed if it is never completed.
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
  /// named: the file has the temporary name from the beginning, because a sandbox may forbid to give it one.
  enum class Meanwhile { nameless, named };

  explicit PartFile(const std::string& path, Meanwhile meanwhile = Meanwhile::nameless);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  /// Writes after everything written so far.
  void append(std::span<const std::byte> bytes);
  /// Overwrites what was written there.
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
  std::string beside_;     ///< temporary name in the same folder
  bool has_name_ = false;  ///< whether the file has the name `beside_`
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

}  // namespace understudy::volume
