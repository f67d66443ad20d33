// SPDX-License-Identifier: Apache-2.0
#include "spu/print/call_text.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>
#include <string_view>

#include "dispatch/call_shape.h"
#include "dispatch/call_words.h"
#include "spu/stream/argument_bytes.h"

namespace understudy::spu {
namespace {

using Text = fmt::memory_buffer;

constexpr std::size_t most_values_shown = 16;
constexpr std::size_t most_characters_shown = 64;
/// Linux maps no object below this address (vm.mmap_min_addr): such a pointer is an offset into a buffer.
constexpr std::uint64_t lowest_address = 65536;

template <class... Arguments>
void append(Text& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
}

void append_enumerant(Text& text, std::uint32_t value, std::uint16_t group) {
  // Dozens of enumerants are 0 or 1, and without a group none of their names is preferable.
  const char* name = group != 0 || value > 1 ? enum_name(value, group) : nullptr;
  if (name != nullptr) {
    append(text, "{}", name);
  } else {
    append(text, "0x{:04x}", value);
  }
}

void append_bits(Text& text, std::uint32_t value, std::uint16_t group) {
  if (value == 0 || group == 0 || value == 0xffffffff) {
    append(text, "0x{:x}", value);
    return;
  }
  const char* between = "";
  for (std::uint32_t rest = value; rest != 0; rest &= rest - 1) {
    const std::uint32_t bit = rest & ~(rest - 1);
    append(text, "{}", between);
    if (const char* name = enum_name(bit, group)) {
      append(text, "{}", name);
    } else {
      append(text, "0x{:x}", bit);
    }
    between = " | ";
  }
}

/// `word` as dispatch/call_words.h encodes a value of this type.
void append_value(Text& text, ValueType type, std::uint16_t group, std::uint64_t word) {
  switch (type) {
    case ValueType::none:
      return;
    case ValueType::boolean:
      if (word > 1) {
        append(text, "{}", word);
      } else {
        append(text, "{}", word != 0 ? "GL_TRUE" : "GL_FALSE");
      }
      return;
    case ValueType::enumeration:
      return append_enumerant(text, std::uint32_t(word), group);
    case ValueType::bitfield:
      return append_bits(text, std::uint32_t(word), group);
    case ValueType::int32:
      // Commands of OpenGL 1.0 take some enumerants as integers; 1 to 4 may also be numbers of components.
      if (group != 0 && std::int64_t(word) > 0xff) return append_enumerant(text, std::uint32_t(word), group);
      [[fallthrough]];
    case ValueType::int8:
    case ValueType::int16:
    case ValueType::int64:
      return append(text, "{}", std::int64_t(word));
    case ValueType::uint8:
    case ValueType::uint16:
    case ValueType::uint32:
    case ValueType::uint64:
      return append(text, "{}", word);
    case ValueType::float32:
      return append(text, "{}", std::bit_cast<float>(std::uint32_t(word)));
    case ValueType::float64:
      return append(text, "{}", std::bit_cast<double>(word));
    case ValueType::fixed:
      return append(text, "{}", double(std::int32_t(word)) / 65536);
    case ValueType::float16:
    case ValueType::character:
    case ValueType::untyped:
    case ValueType::address:
      return append(text, "0x{:x}", word);
  }
}

template <class Value>
std::uint64_t value_at(const std::byte* bytes) {
  Value value;
  std::memcpy(&value, bytes, sizeof value);
  return std::uint64_t(value);
}

/// Reads a value of this type from memory, as a word.
std::uint64_t word_at(ValueType type, const std::byte* bytes) {
  switch (type) {
    case ValueType::int8:
      return value_at<std::int8_t>(bytes);
    case ValueType::int16:
      return value_at<std::int16_t>(bytes);
    case ValueType::int32:
    case ValueType::fixed:
      return value_at<std::int32_t>(bytes);
    default:
      break;
  }
  switch (value_size(type)) {
    case 1:
      return value_at<std::uint8_t>(bytes);
    case 2:
      return value_at<std::uint16_t>(bytes);
    case 4:
      return value_at<std::uint32_t>(bytes);
    default:
      return value_at<std::uint64_t>(bytes);
  }
}

void append_quoted(Text& text, std::string_view characters) {
  append(text, "\"");
  for (const char c : characters.substr(0, most_characters_shown)) {
    switch (c) {
      case '\n':
        append(text, "\\n");
        break;
      case '"':
      case '\\':
        append(text, "\\{}", c);
        break;
      default:
        append(text, "{}", (c >= 0 && c < ' ') || c == 127 ? '?' : c);
    }
  }
  append(text, "\"{}", characters.size() > most_characters_shown ? "..." : "");
}

/// Whether the argument must point to memory of the application that holds values of the argument's type.
bool may_be_read(const ParameterShape& parameter) {
  if (parameter.pointer != 1 || parameter.type == ValueType::untyped) return false;
  switch (parameter.rule) {
    case ExtentRule::counted:
      return true;
    case ExtentRule::text:
    case ExtentRule::text_or_counted:
    case ExtentRule::parameter_values:
    case ExtentRule::clear_value:
      return parameter.input;
    default:
      return false;
  }
}

/// Appends an offset, or an address in another process.
void append_number(Text& text, CallId call, std::size_t index, const std::uint64_t* words) {
  const ParameterShape& parameter = call_shape(call).parameters()[index];
  const bool texts = parameter.rule == ExtentRule::text || parameter.rule == ExtentRule::text_or_counted;
  const auto bytes = texts ? std::nullopt : argument_bytes(call, index, words);
  if (bytes && words[index] < lowest_address) return append(text, "{} bytes at {}", *bytes, words[index]);
  append(text, "0x{:x}", words[index]);
}

void append_pointer(Text& text, CallId call, std::size_t index, const std::uint64_t* words) {
  const ParameterShape& parameter = call_shape(call).parameters()[index];
  const std::optional<std::size_t> bytes = argument_bytes(call, index, words);
  if (!bytes) return append(text, "0x{:x}", words[index]);
  if (words[index] < lowest_address) return append(text, "{} bytes at {}", *bytes, words[index]);
  if (parameter.rule == ExtentRule::texts) return append(text, "{} texts", *bytes / sizeof(char*));
  const std::size_t size = std::max<std::size_t>(value_size(parameter.type), 1);
  const std::size_t count = *bytes / size;
  if (!may_be_read(parameter)) return append(text, "{} bytes", *bytes);
  const auto* values = argument<const std::byte*>(words[index]);
  if (parameter.type == ValueType::character && parameter.input) {
    const auto* characters = reinterpret_cast<const char*>(values);
    return append_quoted(text, {characters, strnlen(characters, count)});
  }
  if (count > most_values_shown || parameter.type == ValueType::character)
    return append(text, "{} bytes", *bytes);
  append(text, "{{");
  for (std::size_t i = 0; i < count; ++i) {
    append(text, "{}", i > 0 ? ", " : "");
    append_value(text, parameter.type, parameter.enum_group, word_at(parameter.type, values + i * size));
  }
  append(text, "}}");
}

void append_result(Text& text, CallId call, std::uint64_t result) {
  const CallShape& shape = call_shape(call);
  if (shape.result == ValueType::none && shape.result_pointer == 0) return;
  append(text, " = ");
  if ((call == CallId::GetString || call == CallId::GetStringi) && result != 0) {
    append_quoted(text, argument<const char*>(result));
  } else if (shape.result_pointer > 0) {
    append(text, "0x{:x}", result);
  } else if (call == CallId::GetError && result == GL_NO_ERROR) {
    append(text, "GL_NO_ERROR");
  } else {
    append_value(text, shape.result, 0, result);
  }
}

}  // namespace

bool shows_outcome(CallId call) {
  const CallShape& shape = call_shape(call);
  if (shape.result != ValueType::none || shape.result_pointer > 0) return true;
  const auto parameters = shape.parameters();
  return std::any_of(parameters.begin(), parameters.end(), [](const ParameterShape& parameter) {
    return !parameter.input && may_be_read(parameter);
  });
}

void append_call(fmt::memory_buffer& text, CallId call, const std::uint64_t* words, std::uint64_t result,
                 UnreadArguments unread) {
  append(text, "{}(", call_name(call));
  const auto parameters = call_shape(call).parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    append(text, "{}{} = ", i > 0 ? ", " : "", parameters[i].name());
    if (parameters[i].pointer > 0 && words[i] == 0) {
      append(text, "NULL");
    } else if (parameters[i].pointer > 0 && (unread >> i & 1U) != 0) {
      append_number(text, call, i, words);
    } else if (parameters[i].pointer > 0) {
      append_pointer(text, call, i, words);
    } else {
      append_value(text, parameters[i].type, parameters[i].enum_group, words[i]);
    }
  }
  append(text, ")");
  append_result(text, call, result);
}

}  // namespace understudy::spu
