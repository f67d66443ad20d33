// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/option_table/manual_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>
#include <vector>

namespace understudy::launcher {

namespace {

/// Escapes text for man(7): dashes stay dashes, and a line that begins with a dot or a quote is text.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool begins_line = out.empty() || out.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string name_of(const OptionRow& option) {
  if (option.names.empty()) return fmt::format("\\fI{}\\fR", escaped(option.place));
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(fmt::format("\\fB{}\\fR", escaped(name)));
  const std::string all = fmt::format("{}", fmt::join(names, ", "));
  return option.value.empty() ? all : fmt::format("{} \\fI{}\\fR", all, escaped(option.value));
}

void add_options(const SubcommandRow& subcommand, std::string& out) {
  std::vector<std::string> headings;
  for (const OptionRow& option : subcommand.options)
    if (std::ranges::find(headings, option.heading) == headings.end()) headings.push_back(option.heading);
  for (const std::string& heading : headings) {
    if (headings.size() > 1) fmt::format_to(std::back_inserter(out), ".PP\n{}:\n", escaped(heading));
    for (const OptionRow& option : subcommand.options) {
      if (option.heading != heading) continue;
      fmt::format_to(std::back_inserter(out), ".TP\n{}\n{}\n", name_of(option), escaped(option.description));
    }
  }
}

}  // namespace

std::string text_of(const ManualPage& page) {
  std::string capitals = page.program;
  std::ranges::transform(capitals, capitals.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  std::string out = fmt::format(
      ".TH {} 1 \"\" \"{} {}\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n\\fIsubcommand\\fR "
      "[\\fIoptions\\fR]\n.SH SUBCOMMANDS\n",
      capitals, page.program, page.version, escaped(page.program), escaped(page.summary),
      escaped(page.program));
  for (const SubcommandRow& row : page.subcommands) {
    fmt::format_to(std::back_inserter(out), ".SS {} {}\n{}\n", escaped(page.program), escaped(row.name),
                   escaped(row.description));
    add_options(row, out);
  }
  out += ".SH OTHER PROGRAMS\n";
  for (const auto& [program, description] : page.others)
    fmt::format_to(std::back_inserter(out), ".TP\n\\fB{}\\fR\n{}\n", escaped(program), escaped(description));
  return out;
}

}  // namespace understudy::launcher
