// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/call_answer.h"

#include <array>
#include <cstring>

#include "spu/stream/record.h"

namespace understudy::spu {
namespace {

constexpr std::size_t head_words = 2;
constexpr std::size_t output_words = 9;

}  // namespace

std::vector<std::byte> encode(const CallAnswer& answer) {
  std::size_t words = head_words;
  for (const AnsweredOutput& output : answer.outputs) words += output_words + words_for(output.bytes.size());
  std::vector<std::byte> bytes(words * 8);
  std::byte* to = bytes.data();
  const auto put = [&](std::span<const std::uint64_t> values) {
    std::memcpy(to, values.data(), values.size_bytes());
    to += values.size_bytes();
  };
  put(std::array<std::uint64_t, head_words>{answer.result, answer.outputs.size()});
  for (const AnsweredOutput& output : answer.outputs) {
    const ImageShape shape = output.image.value_or(ImageShape{});
    put(std::array<std::uint64_t, output_words>{output.parameter, output.image.has_value(),
                                                std::uint32_t(shape.width), std::uint32_t(shape.height),
                                                std::uint32_t(shape.depth), shape.format, shape.type,
                                                std::uint32_t(shape.dimensions), output.bytes.size()});
    if (!output.bytes.empty()) std::memcpy(to, output.bytes.data(), output.bytes.size());
    to += words_for(output.bytes.size()) * 8;
  }
  return bytes;
}

std::optional<CallAnswer> decode_answer(std::span<const std::byte> bytes) {
  std::array<std::uint64_t, output_words> words{};
  const auto take = [&](std::size_t count) {
    if (bytes.size() < count * 8) return false;
    std::memcpy(words.data(), bytes.data(), count * 8);
    bytes = bytes.subspan(count * 8);
    return true;
  };
  CallAnswer answer;
  if (!take(head_words)) return std::nullopt;
  answer.result = words[0];
  const std::uint64_t outputs = words[1];
  for (std::uint64_t i = 0; i < outputs; ++i) {
    if (!take(output_words) || words[8] > bytes.size() || words_for(words[8]) * 8 > bytes.size())
      return std::nullopt;
    AnsweredOutput& output = answer.outputs.emplace_back();
    output.parameter = std::uint32_t(words[0]);
    if (words[1] != 0) {
      output.image = ImageShape{GLsizei(words[2]), GLsizei(words[3]), GLsizei(words[4]),
                                GLenum(words[5]),  GLenum(words[6]),  int(words[7])};
    }
    output.bytes.assign(bytes.begin(), bytes.begin() + std::ptrdiff_t(words[8]));
    bytes = bytes.subspan(words_for(words[8]) * 8);
  }
  return bytes.empty() ? std::optional(std::move(answer)) : std::nullopt;
}

}  // namespace understudy::spu
