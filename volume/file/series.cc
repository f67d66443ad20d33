// SPDX-License-Identifier: Apache-2.0
#include "volume/file/series.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "volume/file/file_error.h"
#include "volume/file/synthetic.h"

namespace understudy::volume {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The digits at `at`, without leading zeros.
std::string_view number_at(const std::string& text, std::size_t at) {
  const std::size_t end = std::min(text.size(), text.find_first_not_of("0123456789", at));
  const std::size_t first = std::min(end, text.find_first_not_of('0', at));
  return std::string_view(text).substr(first, end - first);
}

std::vector<std::string> matches_of(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), GLOB_NOSORT | GLOB_MARK, nullptr, &found) == 0)
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  std::erase_if(files, [](const std::string& file) { return file.ends_with('/'); });
  ::globfree(&found);
  std::ranges::sort(files, comes_before);
  return files;
}

}  // namespace

bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string_view x = number_at(a, i), y = number_at(b, k);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
      i = std::min(a.size(), a.find_first_not_of("0123456789", i));
      k = std::min(b.size(), b.find_first_not_of("0123456789", k));
      continue;
    }
    if (a[i] != b[k]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]);
    ++i;
    ++k;
  }
  const bool over = i >= a.size() && k >= b.size();
  return over ? a < b : i >= a.size();
}

std::string name_of(const SeriesStep& step) {
  const std::string file = std::filesystem::path(step.file).filename().string();
  return step.in_file ? fmt::format("{}, {}", file, *step.in_file) : file;
}

std::vector<std::string> files_of_series(const std::vector<std::string>& names) {
  std::vector<std::string> files;
  for (const std::string& name : names) {
    std::error_code none;
    const bool is_pattern = name.find_first_of("*?[") != std::string::npos;
    if (is_synthetic(name) || !is_pattern || std::filesystem::exists(name, none)) {
      files.push_back(name);
      continue;
    }
    const std::vector<std::string> matches = matches_of(name);
    if (matches.empty())
      throw FileError(fmt::format("{}: no file has such a name; check the path, and quote the pattern", name));
    files.insert(files.end(), matches.begin(), matches.end());
  }
  if (files.size() > max_time_steps)
    throw FileError(
        fmt::format("{} files are too many for a series (at most {})", files.size(), max_time_steps));
  return files;
}

}  // namespace understudy::volume
