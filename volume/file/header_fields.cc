// SPDX-License-Identifier: Apache-2.0
#include "volume/file/header_fields.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <utility>

#include "volume/file/file_error.h"

namespace understudy::volume {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::string> words_of(const std::string& text, std::size_t most) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; words.size() <= most && stream >> word;) words.push_back(word);
  return words;
}

HeaderFields::HeaderFields(std::string format, std::string path)
    : format_(std::move(format)), path_(std::move(path)) {}

void HeaderFields::add(const std::string& name, const std::string& value) {
  if (!fields_.emplace(name, value).second)
    fail(fmt::format("its header has the field '{}' twice; remove one", name));
}

std::string HeaderFields::text(const char* name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string() : found->second;
}

std::string HeaderFields::required(const char* name) const {
  std::string value = text(name);
  if (value.empty()) fail(fmt::format("its header has no field '{}'; get the file again", name));
  return value;
}

std::int64_t HeaderFields::integer(const char* name, const std::string& value, std::int64_t low,
                                   std::int64_t high) const {
  std::int64_t number = 0;
  const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || stop != value.data() + value.size() || number < low || number > high)
    fail(fmt::format("its field '{}' is '{}', not a number of {} to {}; check its header", name, value, low,
                     high));
  return number;
}

void HeaderFields::fail(const std::string& what) const {
  throw FileError(fmt::format("{}: not a readable {} file: {}", path_, format_, what));
}

}  // namespace understudy::volume
