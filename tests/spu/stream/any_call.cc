// SPDX-License-Identifier: Apache-2.0
#include "tests/spu/stream/any_call.h"

#include <cstring>
#include <string_view>

namespace understudy::spu::testing {
namespace {

constexpr std::size_t memory_bytes = std::size_t(16) * 1024;
constexpr std::uint64_t count = 3;

std::uint64_t value_of(const ParameterShape& parameter, std::string_view call, std::mt19937& random) {
  const std::string_view name = parameter.name();
  switch (parameter.type) {
    case ValueType::enumeration:
      if (name == "format") return GL_RGBA;
      if (name == "type")
        return call.find("Elements") != call.npos || call == "glCallLists" ? GL_UNSIGNED_INT : GL_FLOAT;
      if (name == "target" && call.starts_with("glMap1")) return GL_MAP1_VERTEX_3;
      if (name == "target" && call.starts_with("glMap2")) return GL_MAP2_VERTEX_3;
      if (name == "mode" && call == "glNewList") return GL_COMPILE;
      return GL_TEXTURE_2D;
    case ValueType::int32:
      return count;
    case ValueType::uint32:
    case ValueType::bitfield:
      return random() % 200;
    case ValueType::int64:
    case ValueType::uint64:
      return count;
    case ValueType::boolean:
      return random() % 2;
    case ValueType::int8:
    case ValueType::int16:
      return std::uint64_t(std::int64_t(random() % 200) - 100);
    case ValueType::uint8:
    case ValueType::uint16:
    case ValueType::float16:
      return random() % 200;
    case ValueType::fixed:
      return std::uint64_t(std::int64_t(std::int32_t(random())));
    case ValueType::float32:
      return random() & 0x3fff'ffffU;
    case ValueType::float64:
      return std::uint64_t(random()) << 32 & 0x3fff'ffff'ffff'ffffU;
    default:
      return random();
  }
}

}  // namespace

AnyCall::AnyCall(CallId call, std::mt19937& random) {
  const auto parameters = call_shape(call).parameters();
  const std::string_view name = call_name(call);
  const auto new_memory = [&]() -> std::vector<std::byte>& {
    std::vector<std::byte>& memory = memory_.emplace_back(memory_bytes);
    for (std::byte& byte : memory) byte = std::byte(random() % 255 + 1);
    memory[random() % 200] = std::byte(0);
    return memory;
  };
  memory_.reserve(8 * (count + 1));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (parameter.pointer == 0) {
      words_[p] = value_of(parameter, name, random);
      continue;
    }
    std::vector<std::byte>& memory = new_memory();
    words_[p] = reinterpret_cast<std::uintptr_t>(memory.data());
    const bool counts = std::string_view(parameter.name()) == "length" ||
                        std::string_view(parameter.name()) == "count" ||
                        std::string_view(parameter.name()) == "first";
    for (std::uint64_t i = 0; i < count && (counts || parameter.pointer > 1); ++i) {
      if (counts && parameter.pointer == 1) {
        const GLint small = 5;
        std::memcpy(memory.data() + i * sizeof small, &small, sizeof small);
      } else {
        const auto pointee = reinterpret_cast<std::uintptr_t>(new_memory().data());
        std::memcpy(memory.data() + i * sizeof pointee, &pointee, sizeof pointee);
      }
    }
  }
}

}  // namespace understudy::spu::testing
