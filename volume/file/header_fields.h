// SPDX-License-Identifier: Apache-2.0
// Headers that are lines of text with a field each: what NRRD and MetaImage have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::volume {

/// Without the blanks around it.
std::string trimmed(std::string_view text);

/// Between blanks; no more than `most` and one.
std::vector<std::string> words_of(const std::string& text, std::size_t most);

class HeaderFields {
 public:
  /// For messages: what the format is called, and where the file lies.
  HeaderFields(std::string format, std::string path);

  /// Throws FileError when there is one of this name.
  void add(const std::string& name, const std::string& value);

  /// Empty when there is none.
  std::string text(const char* name) const;
  /// Throws FileError when there is none, or nothing in it.
  std::string required(const char* name) const;
  /// `value`, which came from the field `name`. Throws FileError unless it is a number of `low` to `high`.
  std::int64_t integer(const char* name, const std::string& value, std::int64_t low, std::int64_t high) const;

  /// Throws FileError.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string format_;
  std::string path_;
  std::map<std::string, std::string> fields_;
};

}  // namespace understudy::volume
