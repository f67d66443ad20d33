// SPDX-License-Identifier: Apache-2.0
// Text headers with one field per line: shared by NRRD and MetaImage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::volume {

/// Removes leading and trailing blanks.
std::string trimmed(std::string_view text);

/// The words of `text`, separated by blanks; at most `most` + 1 of them.
std::vector<std::string> words_of(const std::string& text, std::size_t most);

class HeaderFields {
 public:
  /// The name of the format and the file's path, for messages.
  HeaderFields(std::string format, std::string path);

  /// Throws FileError if there is a field of this name already.
  void add(const std::string& name, const std::string& value);

  /// Empty if there is no such field.
  std::string text(const char* name) const;
  /// Throws FileError if there is no such field, or it is empty.
  std::string required(const char* name) const;
  /// Parses `value`, the text of the field `name`. Throws FileError unless it is a number from `low` to `high`.
  std::int64_t integer(const char* name, const std::string& value, std::int64_t low, std::int64_t high) const;

  /// Throws FileError.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string format_;
  std::string path_;
  std::map<std::string, std::string> fields_;
};

}  // namespace understudy::volume
