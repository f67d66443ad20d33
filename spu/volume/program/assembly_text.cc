// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/assembly_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace understudy::spu::program {
namespace {

/// "!!ARBfp1.0" or "!!ARBvp1.0"; instructions may follow in the same line.
constexpr std::string_view header = "!!ARBfp1.0";

bool is_blank(char letter) {
  return std::isspace(static_cast<unsigned char>(letter)) != 0;
}

std::string without_comments(const std::string& text) {
  std::string kept;
  bool comment = false;
  for (const char letter : text) {
    if (letter == '\n' || letter == '\r') comment = false;
    if (letter == '#') comment = true;
    kept += comment ? ' ' : letter;
  }
  return kept;
}

/// Splits at commas outside of brackets and braces, and drops blanks.
std::vector<std::string> split_operands(std::string_view text) {
  std::vector<std::string> operands;
  std::string current;
  int depth = 0;
  for (const char letter : text) {
    if (letter == '{' || letter == '[') ++depth;
    if (letter == '}' || letter == ']') --depth;
    if (letter == ',' && depth == 0) {
      operands.push_back(std::exchange(current, {}));
    } else if (!is_blank(letter)) {
      current += letter;
    }
  }
  if (!current.empty()) operands.push_back(std::move(current));
  return operands;
}

Instruction instruction_of(std::string_view statement, int line) {
  const auto first = std::ranges::find_if_not(statement, is_blank);
  const auto end = std::find_if(first, statement.end(), is_blank);
  Instruction instruction{.name = std::string(first, end), .operands = {}, .line = line};
  instruction.saturates = instruction.name.ends_with("_SAT");
  if (instruction.saturates) instruction.name.resize(instruction.name.size() - 4);
  instruction.operands = split_operands({end, statement.end()});
  return instruction;
}

/// Maps 'r', 'g', 'b', 'a' to 'x', 'y', 'z', 'w'; returns 0 for other letters.
char component_letter(char letter) {
  static constexpr std::string_view letters = "xyzwrgba";
  const std::size_t found = letters.find(letter);
  return found == std::string_view::npos ? '\0' : letters[found % 4];
}

}  // namespace

std::vector<Instruction> instructions_of(const std::string& text) {
  const std::string plain = without_comments(text);
  std::vector<Instruction> instructions;
  std::size_t start = std::min(header.size(), plain.size());
  int line = 1;
  for (std::size_t i = start; i < plain.size(); ++i) {
    if (plain[i] != ';') continue;
    const std::string_view statement(plain.data() + start, i - start);
    const auto first = std::ranges::find_if_not(statement, is_blank);
    const int blank_lines = int(std::count(statement.begin(), first, '\n'));
    if (first != statement.end()) instructions.push_back(instruction_of(statement, line + blank_lines));
    line += int(std::ranges::count(statement, '\n'));
    start = i + 1;
  }
  return instructions;
}

Operand operand_of(const std::string& text) {
  Operand operand;
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  operand.negative = text.starts_with('-');
  operand.name = text.substr(sign);
  const std::size_t dot = operand.name.rfind('.');
  const std::size_t brace = operand.name.rfind('}');  // a dot before it is one of a number
  const bool in_braces = brace != std::string::npos && dot < brace;
  if (dot == std::string::npos || in_braces || operand.name.size() - dot > 5) return operand;
  for (const char letter : operand.name.substr(dot + 1)) operand.swizzle += component_letter(letter);
  if (operand.swizzle.find('\0') != std::string::npos || operand.swizzle.empty())
    operand.swizzle.clear();
  else
    operand.name.resize(dot);
  return operand;
}

}  // namespace understudy::spu::program
