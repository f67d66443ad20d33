// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/driver_macros.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <set>
#include <string_view>

namespace understudy::spu::program {
namespace {

constexpr std::array<std::string_view, 8> standard{"GL_ES",         "GL_core_profile",
                                                   "GL_es_profile", "GL_compatibility_profile",
                                                   "__VERSION__",   "GL_FRAGMENT_PRECISION_HIGH",
                                                   "__LINE__",      "__FILE__"};

bool is_in_word(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

/// Returns what follows the `#`; empty if the line is no directive. Skips comments before it.
std::string_view directive_in(std::string_view line) {
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    if (!line.starts_with("/*")) break;
    const std::size_t end = line.find("*/");
    if (end == std::string_view::npos) return {};
    line.remove_prefix(end + 2);
  }
  if (!line.starts_with('#')) return {};
  line.remove_prefix(1);
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return line;
}

std::string_view first_word(std::string_view text) {
  const auto end = std::ranges::find_if_not(text, is_in_word);
  return text.substr(0, std::size_t(end - text.begin()));
}

/// Returns whether the directive can contain macros that decide what is compiled.
bool decides(std::string_view directive) {
  const std::string_view name = first_word(directive);
  return name == "if" || name == "ifdef" || name == "ifndef" || name == "elif" || name == "define";
}

class MacroReader {
 public:
  explicit MacroReader(const std::span<const std::string>* extensions) : extensions_(extensions) {}

  std::string line(std::string_view line) {
    const std::string_view directive = directive_in(line);
    const bool read = continues_ || decides(directive);
    if (first_word(directive) == "define") note_definition(directive);
    continues_ = read && (line.ends_with('\\') || line.ends_with("\\\r"));
    return read ? replaced(line) : std::string(line);
  }

  const std::optional<std::string>& unknown() const { return unknown_; }

 private:
  void note_definition(std::string_view directive) {
    directive.remove_prefix(std::min(directive.find_first_of(" \t"), directive.size()));
    directive.remove_prefix(std::min(directive.find_first_not_of(" \t"), directive.size()));
    own_.emplace(first_word(directive));
  }

  std::string replaced(std::string_view line) {
    std::string text;
    for (std::size_t i = 0; i < line.size();) {
      const std::string_view word = first_word(line.substr(i));
      text += word.empty() ? std::string(1, line[i]) : answer(word);
      i += std::max(word.size(), std::size_t(1));
    }
    return text;
  }

  std::string answer(std::string_view word) {
    const bool of_driver = word.starts_with("GL_") || word.starts_with("__");
    if (!of_driver || own_.contains(word) || std::ranges::find(standard, word) != standard.end())
      return std::string(word);
    if (extensions_ == nullptr || word.starts_with("__")) {
      unknown_ = word;
      return std::string(word);
    }
    return std::ranges::find(*extensions_, word) != extensions_->end() ? "understudy_present"
                                                                       : "understudy_absent";
  }

  const std::span<const std::string>* extensions_;
  std::set<std::string, std::less<>> own_;  ///< defined by the source
  std::optional<std::string> unknown_;
  bool continues_ = false;
};

}  // namespace

std::variant<std::string, Failure> with_driver_macros(const std::string& source,
                                                      const std::span<const std::string>* extensions) {
  MacroReader reader(extensions);
  std::string text;
  for (std::size_t start = 0; start < source.size();) {
    const std::size_t end = std::min(source.find('\n', start), source.size());
    text += reader.line(std::string_view(source).substr(start, end - start));
    if (end < source.size()) text += '\n';
    start = end + 1;
  }
  if (reader.unknown())
    return Failure{Failure::Kind::unsupported,
                   "what is compiled depends on " + *reader.unknown() + ", which the driver defines or not"};
  return text;
}

}  // namespace understudy::spu::program
