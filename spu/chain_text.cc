// SPDX-License-Identifier: Apache-2.0
#include "spu/chain_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "spu/former_names.h"

namespace understudy::spu {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

bool is_plain(char c) {
  return !is_space(c) && c != ',' && c != '(' && c != ')' && c != '"';
}

class ChainTextReader {
 public:
  explicit ChainTextReader(std::string_view text) : text_(text) {}

  ChainSettings chain() {
    ChainSettings units;
    for (skip_space(); !at_end(); skip_space()) {
      if (units.size() == max_chain_units) fail(fmt::format("a chain has at most {} units", max_chain_units));
      units.push_back(unit());
    }
    return units;
  }

 private:
  UnitSetting unit() {
    UnitSetting unit;
    unit.where = where();
    unit.name = name_or_file();
    skip_space();
    if (at_end() || peek() != '(') return unit;
    const std::string opened = where();
    ++position_;
    for (skip_space(); !at_end() && peek() != ')'; skip_space()) {
      unit.options.push_back(option());
      skip_space();
      if (!at_end() && peek() == ',') {
        ++position_;
      } else if (!at_end() && peek() != ')') {
        fail(
            fmt::format("',' or ')' belongs here, not '{}'; write a value with spaces, commas or parentheses "
                        "between double quotes",
                        shown(text_.substr(position_, 1))));
      }
    }
    if (at_end()) throw ChainError(opened, "this parenthesis is not closed; put ')' behind the last option");
    ++position_;
    return unit;
  }

  std::string name_or_file() {
    const std::size_t start = position_;
    if (!at_end() && peek() == '"') {
      std::string file = quoted();
      if (file.find('/') != std::string::npos) return file;
      position_ = start;
      fail("between double quotes, a unit is the path of a file, with a slash in it");
    }
    std::string file = plain();
    if (file.find('/') != std::string::npos) return file;
    position_ = start;
    return present_unit(name("a unit's name"));
  }

  OptionSetting option() {
    OptionSetting option;
    option.where = where();
    option.name = present_unit_option(name("an option's name"));
    skip_space();
    if (at_end() || peek() != '=') {
      option.value = "on";
      return option;
    }
    ++position_;
    skip_space();
    option.value = !at_end() && peek() == '"' ? quoted() : plain();
    return option;
  }

  std::string name(const char* what) {
    const std::size_t start = position_;
    while (!at_end() && is_name(peek())) ++position_;
    if (start == position_) {
      fail(fmt::format("{} belongs here (letters, digits, '-' and '_'), not '{}'", what,
                       at_end() ? "the end" : shown(text_.substr(position_, 1))));
    }
    return std::string(text_.substr(start, position_ - start));
  }

  std::string plain() {
    const std::size_t start = position_;
    while (!at_end() && is_plain(peek())) ++position_;
    return std::string(text_.substr(start, position_ - start));
  }

  std::string quoted() {
    const std::string opened = where();
    std::string value;
    for (++position_; !at_end() && peek() != '"'; ++position_) {
      if (peek() == '\\') {
        ++position_;
        if (at_end() || (peek() != '"' && peek() != '\\')) {
          fail("between double quotes, '\\' stands before '\"' or another '\\' only");
        }
      }
      value += peek();
    }
    if (at_end()) throw ChainError(opened, "this double quote is not closed");
    ++position_;
    return value;
  }

  bool at_end() const { return position_ == text_.size(); }
  char peek() const { return text_[position_]; }
  void skip_space() {
    while (!at_end() && is_space(peek())) ++position_;
  }
  std::string where() const { return fmt::format("chain, character {}", position_ + 1); }
  [[noreturn]] void fail(const std::string& what) const { throw ChainError(where(), what); }

  std::string_view text_;
  std::size_t position_ = 0;
};

std::string value_text(const std::string& value) {
  if (!value.empty() && std::all_of(value.begin(), value.end(), is_plain)) return value;
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

}  // namespace

ChainSettings parse_chain(std::string_view text) {
  if (text.size() > max_chain_bytes) {
    throw ChainError("chain",
                     fmt::format("it is {} bytes long; {} are the limit", text.size(), max_chain_bytes));
  }
  return ChainTextReader(text).chain();
}

std::string chain_text(const ChainSettings& chain) {
  std::string text;
  for (const UnitSetting& unit : chain) {
    text += (text.empty() ? "" : " ") + value_text(unit.name);
    if (unit.options.empty()) continue;
    std::string options;
    for (const OptionSetting& option : unit.options) {
      options += (options.empty() ? "" : ", ") + option.name + "=" + value_text(option.value);
    }
    text += "(" + options + ")";
  }
  return text;
}

std::string shown(std::string_view text) {
  constexpr std::size_t limit = 40;
  std::string result(text.substr(0, limit));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; }, '?');
  return text.size() > limit ? result + "..." : result;
}

}  // namespace understudy::spu
