// SPDX-License-Identifier: Apache-2.0
// What both ends of a connection over TCP must have: the contents of a file that only its owner may read.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace understudy::compositor {

/// Wiped on destruction.
class Secret {
 public:
  explicit Secret(std::span<const std::byte> contents);
  Secret(const Secret&) = default;
  Secret& operator=(const Secret&) = default;
  ~Secret();

  /// 32 bytes, derived from all of the contents.
  std::span<const unsigned char> key() const { return key_; }

 private:
  std::array<unsigned char, 32> key_{};
};

/// Returns the contents of a file that must belong to the user, with mode 0600; empty if it has not `least` to
/// `most` bytes. Errors name `what` it is and where to get one (`origin`). Throws std::runtime_error.
std::vector<std::byte> read_private_file(const std::filesystem::path& file, std::string_view what,
                                         std::string_view origin, std::size_t least, std::size_t most);

/// Makes a file with mode 0600, complete or not at all. Returns false if there is one already. Throws
/// std::runtime_error.
bool make_private_file(const std::filesystem::path& file, std::string_view what,
                       std::span<const std::byte> contents);

/// Throws std::runtime_error, with what to do: no such file, another user's, readable by others, wrong length.
Secret read_secret(const std::filesystem::path& file);

/// The same, but makes the file if there is none, with mode 0600 and 32 random bytes, and sets `made`.
Secret read_or_make_secret(const std::filesystem::path& file, bool& made);

}  // namespace understudy::compositor
