// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/help_layout.h"

#include <algorithm>
#include <initializer_list>
#include <sstream>
#include <string_view>
#include <utility>

namespace understudy::launcher {
namespace {

struct Heading {
  const char* text;
  std::initializer_list<std::string_view> options;
};

const Heading headings[] = {
    {"Samples and colours",
     {"transfer-function", "method", "cut-at-bricks", "tolerance", "operator", "surface", "no-volume", "step",
      "termination", "error", "time"}},
    {"Light", {"light", "light-from", "material"}},
    {"Image", {"camera", "size", "frames", "out", "save-float", "save-frames", "export"}},
    {"The file's scalars", {"volume-size", "type", "big-endian", "spacing", "texels", "range"}},
    {"Nodes",
     {"nodes", "hostfile", "connect", "secret-file", "key", "server-key", "plain", "quality", "backend",
      "memory", "gpu-memory", "sort", "partition", "balance", "exchange", "pixels", "gather", "overlap",
      "tiles"}},
    {"The viewer",
     {"injection", "remote", "server-opengl", "sandbox", "chain", "frame-latency", "control", "require",
      "trace"}},
    {"Checks and figures",
     {"verify", "speed-guard", "disable-optimization", "debug-tint", "explain", "report", "progress", "quiet",
      "print-times"}},
};

/// Returns the number of UTF-8 characters.
std::size_t width(std::string_view text) {
  return std::size_t(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Wraps `text` between words. Lines after the first are indented by `indent` spaces; `used` columns of the
/// first are taken already. Line breaks in the text are kept.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t used) {
  std::string out;
  std::istringstream lines{std::string(text)};
  bool first_line = true;
  for (std::string line; std::getline(lines, line); first_line = false) {
    if (!first_line) out += "\n" + std::string(indent, ' ');
    std::size_t column = first_line ? used : indent;
    bool first_word = true;
    std::istringstream words(line);
    for (std::string word; words >> word; first_word = false) {
      if (!first_word && column + 1 + width(word) > HelpLayout::columns) {
        out += "\n" + std::string(indent, ' ');
        column = indent;
        first_word = true;
      }
      if (!first_word) out += ' ';
      out += word;
      column += width(word) + (first_word ? 0 : 1);
    }
  }
  return out;
}

/// Formats a name in the left column and its description beside it.
std::string row(const std::string& name, const std::string& description, std::size_t column) {
  std::string left = "  " + name;
  if (description.empty()) return left + "\n";
  if (width(left) >= column) {
    left = wrapped(left.substr(2), 6, 2);
    return "  " + left + "\n" + std::string(column, ' ') + wrapped(description, column, column) + "\n";
  }
  left += std::string(column - width(left), ' ');
  return left + wrapped(description, column, column) + "\n";
}

}  // namespace

std::string HelpLayout::make_group(std::string heading, bool is_positional,
                                   std::vector<const CLI::Option*> options) const {
  // CLI11 puts an empty line both before and after each group of options.
  std::string text = CLI::Formatter::make_group(heading, is_positional, std::move(options));
  const bool first = is_positional || heading == "Options";
  return first ? text : text.substr(1);
}

std::string HelpLayout::make_option(const CLI::Option* option, bool is_positional) const {
  return row(make_option_name(option, is_positional) + make_option_opts(option), make_option_desc(option),
             get_column_width());
}

std::string HelpLayout::make_subcommand(const CLI::App* subcommand) const {
  return row(subcommand->get_display_name(true), subcommand->get_description(), get_column_width());
}

std::string HelpLayout::make_description(const CLI::App* app) const {
  const std::string text = CLI::Formatter::make_description(app);
  return text.empty() ? text : wrapped(text, 0, 0) + "\n";
}

std::string HelpLayout::make_footer(const CLI::App* app) const {
  const std::string text = CLI::Formatter::make_footer(app);
  return text.empty() ? text : wrapped(text, 0, 0) + "\n";
}

void group_options(CLI::App& app) {
  for (CLI::App* const subcommand : app.get_subcommands([](const CLI::App*) { return true; })) {
    for (const auto& [text, names] : headings) {
      for (const std::string_view name : names) {
        CLI::Option* const option = subcommand->get_option_no_throw("--" + std::string(name));
        if (option != nullptr && !option->get_group().empty()) option->group(text);
      }
    }
  }
}

}  // namespace understudy::launcher
